# SPDX-License-Identifier: GPL-3.0-or-later
"""Deformation at the knots of the shutter: of meshes, of cages, of what has no lasting mesh."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from export_probe import geometry_of
from hair_parts import furry, grid_points, spiral_curves
from motion_parts import drive, on_every_step, shape_key, with_shutter, xs
from node_parts import with_nodes


@pytest.fixture
def moving(scene):
    return with_shutter(scene)


def test_shape_keys(moving):
    square = scene_parts.add_square(moving)
    drive(shape_key(square), "value", "frame / 20")
    still = scene_parts.add_square(moving, "Still")
    snapshot, report, _ = export_probe.through_engine(moving)
    points = geometry_of(snapshot, "Square")["points"]
    assert points.shape == (2, 4, 3) and points.flags.c_contiguous
    assert points[:, :, 2] == pytest.approx(np.repeat([[0.4875], [0.5125]], 4, axis=1))
    assert geometry_of(snapshot, "Still")["points"].shape == (1, 4, 3)
    assert still.data.vertices[0].co.z == 0.0 and len(report) == 0


def test_a_deformed_cage(moving):
    square = scene_parts.add_square(moving)
    drive(shape_key(square), "value", "frame / 20")
    scene_parts.add_subsurf(square, 3)
    snapshot, _, _ = export_probe.through_engine(moving)
    geometry = geometry_of(snapshot, "Square")
    assert "subdivision" in geometry and geometry["points"].shape == (2, 4, 3)
    assert geometry["points"][:, 0, 2] == pytest.approx([0.4875, 0.5125])


def test_a_moving_subsurf_stays_a_static_cage(moving):
    square = scene_parts.add_square(moving)
    scene_parts.add_subsurf(square, 2)
    drive(square, "location", "frame", 0)
    snapshot, _, _ = export_probe.through_engine(moving)
    assert geometry_of(snapshot, "Square")["points"].shape == (1, 4, 3)
    assert xs(snapshot, "Square") == pytest.approx([9.75, 10.25])


@pytest.mark.parametrize("build", [spiral_curves, grid_points])
def test_radii_in_motion(moving, build):
    """They swell by .01 a frame; where only they move, places have as many knots."""
    thing = build(moving)
    node = next(
        n
        for n in thing.modifiers[0].node_group.nodes
        if "Radius" in n.inputs and n.inputs["Radius"]
    )
    name = f'nodes["{node.name}"].inputs["Radius"].default_value'
    curve = thing.modifiers[0].node_group.driver_add(name)
    curve.driver.expression = ".01 * frame"
    snapshot, report, _ = export_probe.through_engine(moving)
    geometry = next(g for g in snapshot["geometries"] if g["kind"] in ("CURVES", "POINTS"))
    assert len(geometry["radius"]) == len(geometry["points"]) == 2
    assert geometry["radius"][:, 0] == pytest.approx([0.0975, 0.1025], abs=1e-6)
    assert np.array_equal(geometry["points"][0], geometry["points"][1])
    # A spiral's curves are polygons.
    assert all("Catmull-Rom" in message for _, message, _ in report.entries())


@pytest.mark.parametrize("children", ["NONE", "SIMPLE"])
def test_radii_of_particle_hair_in_motion(moving, children):
    """Half the diameter; the first point is a root."""
    settings = {"child_type": children, "rendered_child_count": 3, "shape": 0.0}
    thing = furry(moving, count=2, use_close_tip=False, **settings)
    hair = thing.particle_systems[0].settings
    drive(hair, "radius_scale", ".01 * frame")
    hair.root_radius, hair.tip_radius = 2.0, 1.0
    snapshot, report, _ = export_probe.through_engine(moving)
    (geometry,) = (g for g in snapshot["geometries"] if g["kind"] == "CURVES")
    steps = geometry["curve_sizes"][0]
    assert geometry["radius"][:, 0] == pytest.approx([0.0975, 0.1025], rel=1e-5)
    assert geometry["radius"][:, steps - 1] == pytest.approx([0.04875, 0.05125], rel=1e-5)
    assert np.array_equal(*geometry["points"]) and len(report) == 0


def test_hair_that_only_bends_keeps_its_radii(moving):
    thing = furry(moving, count=2)
    drive(thing.particle_systems[0].settings, "tip_radius", "0.01")
    key = shape_key(thing)
    for point in key.data:
        point.co.z += point.co.x
    drive(key, "value", "frame - 10")
    snapshot, _, _ = export_probe.through_engine(moving)
    (geometry,) = (g for g in snapshot["geometries"] if g["kind"] == "CURVES")
    assert len(geometry["points"]) > 1 and len(geometry["radius"]) == 1


def test_a_tip_that_grows_in_half_of_the_shutter(moving):
    thing = furry(moving, count=2, use_close_tip=False)
    drive(thing.particle_systems[0].settings, "tip_radius", "0.1 + max(frame - 10, 0)")
    snapshot, _, _ = export_probe.through_engine(moving)
    (geometry,) = (g for g in snapshot["geometries"] if g["kind"] == "CURVES")
    steps = geometry["curve_sizes"][0]
    assert geometry["radius"][:, steps - 1] == pytest.approx([0.05, 0.05, 0.175], rel=1e-5)


def sphere(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=32)
    return bpy.context.object


def test_deforming_cages_are_not_subdivided_at_every_knot(moving):
    """A million faces would come of it: what a step costs is seen in the mesh that Blender holds."""
    thing = sphere(moving)
    drive(shape_key(thing), "value", "frame / 20")
    scene_parts.add_subsurf(thing, 2)
    vertices = []

    def count(scene, depsgraph):
        mesh = thing.evaluated_get(depsgraph).data
        vertices.append((scene.frame_current + scene.frame_subframe, len(mesh.vertices)))

    snapshot, _, _ = export_probe.through_engine(moving, **on_every_step(count))
    cage = len(thing.data.vertices)
    assert vertices == [(9.75, cage), (10.25, cage), (10.0, cage)]
    assert geometry_of(snapshot, "Sphere")["points"].shape == (2, cage, 3)
    # The next render finds the modifier switched on.
    assert "subdivision" in geometry_of(export_probe.through_engine(moving)[0], "Sphere")


@pytest.mark.parametrize("through_collection", [False, True])
def test_a_mesh_that_others_read_stays_subdivided(moving, through_collection):
    """A boolean with a deforming subsurf must see its round form at every knot."""
    thing = sphere(moving)
    drive(shape_key(thing), "value", "frame / 20")
    scene_parts.add_subsurf(thing, 1)
    reader = scene_parts.add_square(moving, "Reader", 9.0)
    modifier = reader.modifiers.new("Boolean", "BOOLEAN")
    if through_collection:
        part = bpy.data.collections.new("Part")
        part.objects.link(thing)
        modifier.operand_type, modifier.collection = "COLLECTION", part
    else:
        modifier.object = thing
    sizes = []

    def count(_scene, depsgraph):
        sizes.append(len(thing.evaluated_get(depsgraph).data.vertices))

    export_probe.through_engine(moving, **on_every_step(count))
    assert len(sizes) == 3 and min(sizes) > len(thing.data.vertices)


def test_armature(moving):
    """The square follows a bone that turns; Blender's own evaluation at that time is the truth."""
    square = scene_parts.add_square(moving)
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    square.vertex_groups.new(name=armature.data.bones[0].name).add(range(4), 1.0, "REPLACE")
    square.modifiers.new("Armature", "ARMATURE").object = armature
    bone = armature.pose.bones[0]
    bone.rotation_mode = "XYZ"
    drive(bone, "rotation_euler", "frame / 50", 0)
    expected = []
    for subframe_of in ((9, 0.75), (10, 0.25)):
        moving.frame_set(subframe_of[0], subframe=subframe_of[1])
        evaluated = square.evaluated_get(bpy.context.evaluated_depsgraph_get())
        expected.append([tuple(vertex.co) for vertex in evaluated.data.vertices])
    moving.frame_set(10)
    snapshot, _, _ = export_probe.through_engine(moving)
    assert geometry_of(snapshot, "Square")["points"] == pytest.approx(np.array(expected), abs=1e-6)


def wave_of_nodes(thing):
    """Geometry nodes that lift every point by the scene's time."""

    def build(nodes, links, geometry):
        vector, lift = nodes.new("ShaderNodeCombineXYZ"), nodes.new("GeometryNodeSetPosition")
        links.new(nodes.new("GeometryNodeInputSceneTime").outputs["Frame"], vector.inputs["Z"])
        links.new(vector.outputs[0], lift.inputs["Offset"])
        links.new(geometry, lift.inputs["Geometry"])
        return lift.outputs[0]

    with_nodes(thing, build)


def test_geometry_nodes_that_ask_for_the_time(moving):
    wave_of_nodes(scene_parts.add_square(moving))
    snapshot, _, _ = export_probe.through_engine(moving)
    points = geometry_of(snapshot, "Square")["points"]
    assert points[:, 0, 2] == pytest.approx([9.75, 10.25])


def test_deformed_instances_are_read_once(moving):
    square = scene_parts.add_square(moving)
    wave_of_nodes(square)
    part = bpy.data.collections.new("Part")
    part.objects.link(square)
    moving.collection.objects.unlink(square)
    for i in range(4):
        empty = scene_parts.add_object(moving, f"Place{i}", None, (3 * i, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", part
    snapshot, _, _ = export_probe.through_engine(moving)
    assert snapshot["instances"]["geometry"].tolist() == [0] * 4
    assert snapshot["instances"]["knots"].tolist() == [1] * 4
    assert snapshot["geometries"][0]["points"].shape == (2, 4, 3)


def test_deforming_text(moving):
    """A curve's mesh is found again though it is a new one at every knot."""
    bpy.ops.object.text_add()
    drive(bpy.context.object.data, "extrude", "frame / 10")
    snapshot, report, _ = export_probe.through_engine(moving)
    points = geometry_of(snapshot, "Text")["points"]
    assert points[:, :, 2].max(axis=1) == pytest.approx([0.975, 1.025])
    assert len(report) == 0


def build(square):
    """Faces appear one after another."""
    modifier = square.modifiers.new("Build", "BUILD")
    modifier.frame_start, modifier.frame_duration = 9, 3


def test_changing_topology_keeps_transform_blur_and_is_named(moving):
    verts = [(x, y, 0) for y in range(21) for x in range(21)]
    faces = [(i, i + 1, i + 22, i + 21) for i in range(420) if i % 21 < 20]
    build(scene_parts.add_mesh(moving, "Growing", verts, faces))
    drive(bpy.data.objects["Growing"], "location", "frame", 0)
    snapshot, report, time_after = export_probe.through_engine(moving, motion_steps=5)
    assert geometry_of(snapshot, "Growing")["points"].shape[0] == 1
    assert xs(snapshot, "Growing") == pytest.approx([9.75, 10.25])
    ((datablock, message, count),) = report.entries()
    assert datablock == "mesh 'Growing'" and "topology" in message and count == 1
    assert time_after == 10.0


def test_equal_counts_of_other_faces_do_not_smear(moving):
    """Two meshes of four vertices and one face each, joined in another order, swapped in time."""
    tree = bpy.data.node_groups.new("Swap", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    switch = tree.nodes.new("GeometryNodeSwitch")
    switch.input_type = "GEOMETRY"
    output = tree.nodes.new("NodeGroupOutput")
    geometry = [s for s in switch.inputs if s.type == "GEOMETRY"]
    for socket, order in zip(geometry, ((0, 1, 2, 3), (3, 2, 1, 0))):
        name = f"Source{order[0]}"
        verts = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        source = scene_parts.add_mesh(moving, name, verts, [order])
        source.hide_render = True
        info = tree.nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = source
        tree.links.new(info.outputs["Geometry"], socket)
    tree.links.new(
        next(s for s in switch.outputs if s.type == "GEOMETRY" and s.enabled), output.inputs[0]
    )
    time = tree.nodes.new("GeometryNodeInputSceneTime")
    compare = tree.nodes.new("FunctionNodeCompare")
    compare.operation = "GREATER_THAN"
    compare.inputs[1].default_value = 10.1
    tree.links.new(time.outputs["Frame"], compare.inputs[0])
    flag = next(s for s in switch.inputs if s.type == "BOOLEAN" and s.enabled)
    tree.links.new(compare.outputs[0], flag)
    host = scene_parts.add_square(moving, "Host")
    host.modifiers.new("Nodes", "NODES").node_group = tree
    snapshot, report, _ = export_probe.through_engine(moving)
    assert geometry_of(snapshot, "Host")["points"].shape == (1, 4, 3)
    assert [(d, "topology" in m) for d, m, _ in report.entries()] == [("mesh 'Host'", True)]


def hair_points(snapshot):
    (hair,) = [g for g in snapshot["geometries"] if g["kind"] == "CURVES"]
    return hair["points"]


@pytest.mark.parametrize("children", [{}, {"child_type": "SIMPLE", "rendered_child_count": 5}])
def test_hair_goes_along_with_its_emitter(moving, children):
    thing = furry(moving, brownian_factor=0.1, **children)
    thing.rotation_euler[2], thing.location[0] = 0.3, 40.0
    drive(thing, "rotation_euler", "frame", 1)
    snapshot, _, _ = export_probe.through_engine(moving)
    (points,) = hair_points(snapshot)
    assert len(points) == 60 * (5 if children else 1) * 9
    assert len(np.unique(export_probe.knots_of(snapshot, thing.name), axis=0)) > 2


def test_hair_that_is_rendered_at_some_times_alone_keeps_its_shape(moving):
    """A visibility belongs to the frame."""
    thing = furry(moving)
    drive(thing, "rotation_euler", "frame", 1)
    drive(thing.modifiers["Hair"], "show_render", "frame < 10.1")
    snapshot, _, _ = export_probe.through_engine(moving)
    (points,) = hair_points(snapshot)
    assert len(points) == 60 * 9


def test_hair_that_shrinks_deforms(moving):
    thing = furry(moving, child_type="SIMPLE", rendered_child_count=5)
    drive(thing, "rotation_euler", "frame / 10", 1)
    drive(thing.particle_systems[0].settings, "child_length", "1 - frame / 100")
    snapshot, _, _ = export_probe.through_engine(moving)
    points = hair_points(snapshot)
    tips = points.reshape(len(points), 300, 9, 3)[:, :, -1, 2]
    assert (np.diff(tips, axis=0) < -0.001).all()


def test_hair_that_bends_between_ends_that_stay_deforms(moving):
    """Children that meet at their parents' tips."""
    thing = furry(moving, child_type="SIMPLE", rendered_child_count=5)
    drive(thing, "rotation_euler", "frame / 10", 1)
    settings = thing.particle_systems[0].settings
    settings.clump_factor, settings.kink = 1.0, "WAVE"
    drive(settings, "kink_amplitude", "frame / 20")
    snapshot, _, _ = export_probe.through_engine(moving)
    points = hair_points(snapshot)
    assert len(points) > 1
    strands = points.reshape(len(points), 300, 9, 3)
    way = np.linalg.norm(strands[-1] - strands[0], axis=-1)
    assert way[:, 2].max() > 0.001
    assert way[:, 8].max() < 1e-4


def test_few_hairs_of_many_that_deform(moving):
    """A fiftieth of the emitter rises; the other hairs stay."""
    thing = furry(moving, count=500)
    thing.data.clear_geometry()
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1), (2, 0), (2.28, 0), (2.28, 0.28), (2, 0.28)]
    thing.data.from_pydata([(*c, 0.0) for c in corners], [], [(0, 1, 2, 3), (4, 5, 6, 7)])
    key = shape_key(thing, lift=0.0)
    for point in list(key.data)[4:]:
        point.co.z += 1.0
    drive(key, "value", "frame / 20")
    snapshot, _, _ = export_probe.through_engine(moving)
    points = hair_points(snapshot)
    rises = points[-1][:, 2] - points[0][:, 2] > 0.02
    assert 0.0 < rises.mean() < 0.05
