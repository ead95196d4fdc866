# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair, curves and point clouds for tests: the ways that every Blender has of making them."""

import bpy
import scene_parts
from node_parts import hidden_collection, with_nodes


def spiral_curves(scene, radius=0.06, name="Curves"):
    """A Curves object with one rising spiral of 33 points."""
    thing = scene_parts.add_object(scene, name, bpy.data.hair_curves.new(name))

    def build(nodes, links, _geometry):
        spiral = nodes.new("GeometryNodeCurveSpiral")
        for socket, value in {
            "Resolution": 16,
            "Rotations": 2.0,
            "Start Radius": 0.4,
            "End Radius": 1.6,
            "Height": 1.5,
        }.items():
            spiral.inputs[socket].default_value = value
        if radius is None:
            return spiral.outputs[0]
        width = nodes.new("GeometryNodeSetCurveRadius")
        width.inputs["Radius"].default_value = radius
        links.new(spiral.outputs[0], width.inputs["Curve"])
        return width.outputs[0]

    return with_nodes(thing, build)


def curve_through(scene, places, radius, name="Curve"):
    """A Curves object with one curve through `places`, metres."""
    edges = [(i, i + 1) for i in range(len(places) - 1)]
    path = bpy.data.meshes.new("Path")
    path.from_pydata(places, edges, [])
    source = scene_parts.add_object(scene, "Path", path)
    hidden_collection(scene, source)
    thing = scene_parts.add_object(scene, name, bpy.data.hair_curves.new(name))

    def build(nodes, links, _geometry):
        info = nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = source
        curve = nodes.new("GeometryNodeMeshToCurve")
        # What a mesh becomes is made of straight pieces, which Cycles 5 draws as such, with round ends.
        smooth = nodes.new("GeometryNodeCurveSplineType")
        smooth.spline_type = "CATMULL_ROM"
        width = nodes.new("GeometryNodeSetCurveRadius")
        width.inputs["Radius"].default_value = radius
        links.new(info.outputs["Geometry"], curve.inputs[0])
        links.new(curve.outputs[0], smooth.inputs["Curve"])
        links.new(smooth.outputs[0], width.inputs["Curve"])
        return width.outputs[0]

    return with_nodes(thing, build)


def give_material(thing, material):
    """Of what nodes make: it has none of the object's."""
    group = thing.modifiers[0].node_group
    end = next(n for n in group.nodes if n.bl_idname == "NodeGroupOutput")
    last = end.inputs[0].links[0].from_socket
    given = group.nodes.new("GeometryNodeSetMaterial")
    given.inputs["Material"].default_value = material
    group.links.new(last, given.inputs["Geometry"])
    group.links.new(given.outputs[0], end.inputs[0])


def mesh_points(scene, vertices, faces, radius, name="Cloud"):
    """A mesh whose vertices nodes turn into points."""
    thing = scene_parts.add_mesh(scene, name, vertices, faces)

    def build(nodes, links, geometry):
        points = nodes.new("GeometryNodeMeshToPoints")
        points.inputs["Radius"].default_value = radius
        links.new(geometry, points.inputs["Mesh"])
        return points.outputs[0]

    return with_nodes(thing, build)


def grid_points(scene, radius=0.15, name="Cloud"):
    """A mesh of 7 by 5 vertices, a metre wide and .75 high apart, that nodes turn into points."""
    vertices = [(x - 3.0, 0.75 * (y - 2.0), 0.3 * (x % 3)) for y in range(5) for x in range(7)]
    faces = [(i, i + 1, i + 8, i + 7) for y in range(4) for i in range(7 * y, 7 * y + 6)]
    return mesh_points(scene, vertices, faces, radius, name)


def furry(scene, count=60, name="Furry", **settings):
    """A square with a system of straight hairs a metre long."""
    thing = scene_parts.add_square(scene, name, 2.0)
    thing.modifiers.new("Hair", "PARTICLE_SYSTEM")
    hair = thing.particle_systems[0].settings
    values = {"type": "HAIR", "count": count, "hair_length": 1.0, "root_radius": 0.08}
    values |= {"tip_radius": 0.02, "radius_scale": 1.0, "render_step": 3, **settings}
    for key, value in values.items():
        setattr(hair, key, value)
    return thing
