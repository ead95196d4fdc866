# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes, legacy curves, text, metaballs, hair curves, point clouds, and modifiers that render."""

import bpy
import numpy as np
import scene_parts
import stage
import unwalked
from mathutils import Matrix
from probe import Probe


def _shown(scene, lit=True):
    stage.set_world(scene)
    stage.camera(scene)
    if lit:
        stage.add_sun(scene)


def _painted():
    """Diffuse by UV, the vertex colour and Generated together."""
    made, nodes, links, _output = tree = scene_parts.node_material("Painted")
    coordinate, color, places = (
        nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "VertexColor", "VectorMath")
    )
    links.new(coordinate.outputs["Generated"], places.inputs[0])
    links.new(coordinate.outputs["UV"], places.inputs[1])
    shown = places.outputs[0], color.outputs["Color"]
    stage.show_sum(tree, *shown, part=0.3)
    return made


def _mesh(scene):
    _shown(scene)
    thing = stage.surface(scene, columns=6, size=1.8, height=0.5, material=_painted())
    mesh = thing.data
    second = mesh.uv_layers.new(name="Second")
    uv = np.random.default_rng(2).uniform(0, 1, 2 * len(mesh.loops)).astype(np.float32)
    second.data.foreach_set("uv", uv)
    other = mesh.color_attributes.new("Other", "BYTE_COLOR", "CORNER")
    other.data.foreach_set("color", np.full(4 * len(mesh.loops), 0.3, dtype=np.float32))
    mesh.materials.append(stage.diffuse("Second", (0.9, 0.1, 0.1)))
    return {
        "mesh": mesh,
        "object": thing,
        "face": mesh.polygons[20],
        "vertex": mesh.vertices[24],
        "edge": mesh.edges[30],
        # What `new` gave is gone since the colours came.
        "uv layer": mesh.uv_layers["Second"],
        "colors": mesh.color_attributes,
    }


def _curve(kind):
    def build(scene):
        _shown(scene)
        if kind == "FONT":
            data = bpy.data.curves.new("Text", "FONT")
            data.body, data.align_x, data.size, data.extrude = "Ab", "CENTER", 1.2, 0.1
            data.fill_mode = "BOTH"
        elif kind == "META":
            data = bpy.data.metaballs.new("Ball")
            data.elements.new().radius = 1.2
            data.elements.new().co = (0.8, 0.3, 0)
        else:
            data = bpy.data.curves.new("Curve", "CURVE")
            data.dimensions, data.bevel_depth = "3D", 0.15
            spline = data.splines.new("BEZIER")
            spline.bezier_points.add(2)
            for point, place in zip(
                spline.bezier_points, ((-0.8, -0.5, 0), (0, 0.6, 0.3), (0.8, -0.2, 0))
            ):
                point.co = place
                point.handle_left_type = point.handle_right_type = "AUTO"
        thing = scene_parts.add_object(scene, "Thing", data)
        data.materials.append(stage.glowing("Glow"))
        return {"data": data, "object": thing}

    return build


def _hair_curves(scene):
    _shown(scene)
    if hasattr(bpy.data, "hair_curves") and "add_curves" in bpy.types.Curves.bl_rna.functions:
        data = bpy.data.hair_curves.new("Hair")
        data.add_curves([4] * 12)
        points = np.zeros((48, 3), dtype=np.float32)
        for i in range(12):
            points[4 * i : 4 * i + 4, 0] = -0.8 + 0.15 * i
            points[4 * i : 4 * i + 4, 1] = np.linspace(-0.8, 0.8, 4)
            points[4 * i : 4 * i + 4, 2] = 0.2 * np.sin(np.arange(4) + i)
        data.points.foreach_set("position", points.ravel())
        data.points.foreach_set("radius", np.full(48, 0.05, dtype=np.float32))
        data.materials.append(stage.diffuse("Hair", (0.8, 0.6, 0.3)))
        thing = scene_parts.add_object(scene, "Hair", data)
        return {"data": data, "object": thing, "scene": scene}
    return {}


def _scaled(x, y, z):
    def deed(roots):
        if "object" not in roots:
            return False
        roots["object"].scale = (x, y, z)
        return True

    return deed


_SCALES = {f"scale {scale}": _scaled(*scale) for scale in ((1, 1, 0.2), (0.2, 1, 1), (1, 0.4, 1))}


def _points(scene):
    """A point cloud, made from a mesh by geometry nodes."""
    import node_parts

    _shown(scene)
    material = stage.diffuse("Dots", (0.8, 0.6, 0.3))
    thing = stage.surface(scene, "Dots", 4, 1.4, material=material)

    def build(nodes, links, geometry):
        to_points = nodes.new("GeometryNodeMeshToPoints")
        to_points.inputs["Radius"].default_value = 0.12
        links.new(geometry, to_points.inputs[0])
        paint = nodes.new("GeometryNodeSetMaterial")
        paint.inputs["Material"].default_value = material
        links.new(to_points.outputs[0], paint.inputs[0])
        return paint.outputs[0]

    node_parts.with_nodes(thing, build)
    return {"object": thing}


def _modified(kind):
    def build(scene):
        _shown(scene)
        thing = stage.add_cube(scene, size=1.3, location=(0, 0, 0), material=_painted())
        mesh = thing.data
        if kind == "MIRROR":  # beside the planes: mirrored, it must not meet itself
            mesh.transform(Matrix.Translation((0.4, 0.35, 0.3)) @ Matrix.Scale(0.5, 4))
        stage.finish_mesh(mesh)
        mesh.polygons.foreach_set("use_smooth", [False] * 6)
        mesh.materials.append(stage.diffuse("Second", (0.9, 0.1, 0.1)))
        thing.vertex_groups.new(name="Group").add([0, 1, 2], 1.0, "REPLACE")
        scene_parts.add_object(scene, "Empty", None, (0.3, 0.2, 0.4))
        if "crease" in bpy.types.MeshEdge.bl_rna.properties:
            mesh.edges[0].crease = mesh.edges[5].crease = 0.7
        else:
            values = np.zeros(len(mesh.edges), dtype=np.float32)
            values[[0, 5]] = 0.7
            mesh.attributes.new("crease_edge", "FLOAT", "EDGE").data.foreach_set("value", values)
        if kind == "MULTIRES":
            bpy.context.view_layer.objects.active = thing
        modifier = thing.modifiers.new("Modifier", kind)
        roots = {"object": thing, "mesh": mesh}
        if modifier is None:
            return {}
        if kind == "SUBSURF":
            modifier.render_levels = modifier.levels = 3
        if kind == "MULTIRES":
            bpy.ops.object.multires_subdivide(modifier="Modifier")
            bpy.ops.object.multires_subdivide(modifier="Modifier")
        return {**roots, "modifier": modifier, "scene": scene}

    return build


def _rendered_modifiers():
    """Identifiers of the modifiers of meshes that change something by themselves or with few settings."""
    wanted = {
        "SUBSURF",
        "MULTIRES",
        "ARRAY",
        "BEVEL",
        "DISPLACE",
        "EDGE_SPLIT",
        "MIRROR",
        "SOLIDIFY",
        "SIMPLE_DEFORM",
        "TRIANGULATE",
        "WEIGHTED_NORMAL",
        "NORMAL_EDIT",
        "WIREFRAME",
        "CAST",
        "WAVE",
        "UV_PROJECT",
        "UV_WARP",
    }
    items = bpy.types.Modifier.bl_rna.properties["type"].enum_items
    return [item.identifier for item in items if item.identifier in wanted]


_MESHES = unwalked.names("meshes")
_MODIFIERS = unwalked.names("modifiers")


def probes():
    found = [
        Probe("mesh", _mesh, ("mesh", "face", "vertex", "edge", "uv layer"), {}, _MESHES),
        Probe("curve", _curve("CURVE"), ("data",), {}, _MESHES),
        Probe("text", _curve("FONT"), ("data",), {}, _MESHES),
        Probe("metaball", _curve("META"), ("data",), {}, _MESHES),
        Probe("hair curves", _hair_curves, ("data", "scene.cycles_curves"), _SCALES, _MESHES),
        Probe("point cloud", _points, (), _SCALES),
    ]
    for kind in _rendered_modifiers():
        found.append(Probe(f"modifier {kind}", _modified(kind), ("modifier",), {}, _MODIFIERS))
    return found
