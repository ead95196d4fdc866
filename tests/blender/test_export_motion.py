# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion at the knots of the shutter, and the frame restored on every path."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from export_probe import geometry_of, knots_of

from granita.export import Cancelled, motion


@pytest.fixture
def moving(scene):
    """The scene with motion blur: shutter of half a frame around frame 10."""
    scene_parts.add_camera(scene, (0, 0, 10))
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.5
    set_position(scene, "CENTER")
    scene.frame_set(10)
    return scene


def set_position(scene, position):
    owner = scene.render if hasattr(scene.render, "motion_blur_position") else scene.cycles
    owner.motion_blur_position = position


def drive(owner, path, expression, index=-1):
    """A property that is a formula of `frame`, with its fraction."""
    owner.driver_add(path, index).driver.expression = expression


def xs(snapshot, name):
    return knots_of(snapshot, name)[:, 0, 3]


@pytest.mark.smoke
@pytest.mark.parametrize(
    "position, expected",
    [("CENTER", [9.75, 10, 10.25]), ("START", [10, 10.25, 10.5]), ("END", [9.5, 9.75, 10])],
)
def test_positions_of_the_shutter(moving, position, expected):
    set_position(moving, position)
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    still = scene_parts.add_square(moving, "Still")
    still.location.x = 3.0
    snapshot, report, time_after = export_probe.through_engine(moving)
    assert xs(snapshot, "Square") == pytest.approx(expected)
    assert xs(snapshot, "Still").tolist() == [3.0]
    assert snapshot["options"]["frame_time"] == {"CENTER": 0.5, "START": 0.0, "END": 1.0}[position]
    assert time_after == 10.0 and len(report) == 0


def test_a_script_sees_the_same(moving):
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    snapshot, _ = export_probe.through_script()
    assert xs(snapshot, "Square") == pytest.approx([9.75, 10, 10.25])
    assert (moving.frame_current, moving.frame_subframe) == (10, 0.0)


@pytest.mark.parametrize("steps, knots", [(2, 3), (3, 3), (4, 5), (7, 7)])
def test_more_steps_are_more_knots(moving, steps, knots):
    drive(scene_parts.add_square(moving), "location", "frame * frame", 0)
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=steps)
    times = np.linspace(9.75, 10.25, knots)
    assert xs(snapshot, "Square") == pytest.approx(times * times, rel=1e-6)


def test_motion_off_steps_no_time(moving):
    moving.render.use_motion_blur = False
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    changes = []

    def changed(*_):
        changes.append(1)

    def listen(_depsgraph):
        bpy.app.handlers.frame_change_post.append(changed)

    def stop(_depsgraph):
        bpy.app.handlers.frame_change_post.remove(changed)

    snapshot, _, _ = export_probe.through_engine(moving, before=listen, after=stop)
    assert xs(snapshot, "Square").tolist() == [10.0] and changes == []


@pytest.mark.parametrize("moves", [False, True])
def test_a_scene_that_stands_still_is_walked_once(moving, moves, monkeypatch):
    square = scene_parts.add_square(moving)
    if moves:
        drive(square, "location", "frame", 0)
    walks = []
    walk = motion.visit
    monkeypatch.setattr(motion, "visit", lambda *all_: walks.append(1) or walk(*all_))
    export_probe.through_engine(moving)
    assert len(walks) == (2 if moves else 0)


def test_motion_in_one_half_of_the_shutter(moving):
    """Nothing is updated before the frame, and after it things stay where they went."""
    square = scene_parts.add_square(moving)
    drive(square, "location", "max(frame, 10) if frame < 10.2 else 10.2", 0)
    drive(shape_key(square), "value", "0 if frame < 10.1 else 1")
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=9)
    times = np.linspace(9.75, 10.25, 9)
    assert xs(snapshot, "Square") == pytest.approx(np.clip(times, 10, 10.2))
    lifted = geometry_of(snapshot, "Square")["points"][:, 0, 2]
    assert lifted.tolist() == (times >= 10.1).astype(float).tolist()


@pytest.mark.parametrize("frame", [-3, 0, 1])
def test_negative_and_first_frames(moving, frame):
    moving.frame_set(frame)
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    snapshot, _, time_after = export_probe.through_engine(moving)
    assert xs(snapshot, "Square") == pytest.approx([frame - 0.25, frame, frame + 0.25])
    assert time_after == frame


def test_camera_and_lights_move(moving):
    drive(moving.camera, "location", "frame", 1)
    light = scene_parts.add_object(moving, "Lamp", bpy.data.lights.new("Lamp", "POINT"))
    drive(light, "location", "2 * frame", 2)
    snapshot, _, _ = export_probe.through_engine(moving)
    assert snapshot["camera"]["world_from_camera"][:, 1, 3] == pytest.approx([9.75, 10, 10.25])
    (lamp,) = snapshot["lights"]
    assert lamp["world_from_light"][:, 2, 3] == pytest.approx([19.5, 20, 20.5])


def test_a_parent_and_a_driver(moving):
    parent = scene_parts.add_object(moving, "Parent", None)
    child = scene_parts.add_square(moving, "Child")
    child.parent = parent
    follower = scene_parts.add_square(moving, "Follower")
    drive(parent, "location", "frame", 0)
    driver = follower.driver_add("location", 0).driver
    variable = driver.variables.new()
    variable.name, variable.type = "x", "TRANSFORMS"
    variable.targets[0].id = child
    driver.expression = "-x"
    snapshot, _, _ = export_probe.through_engine(moving)
    assert xs(snapshot, "Child") == pytest.approx([9.75, 10, 10.25])
    assert xs(snapshot, "Follower") == pytest.approx([-9.75, -10, -10.25])


def test_instances_move_each_on_its_own(moving):
    square = scene_parts.add_square(moving)
    part = bpy.data.collections.new("Part")
    part.objects.link(square)
    moving.collection.objects.unlink(square)
    for i in range(3):
        empty = scene_parts.add_object(moving, f"Place{i}", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", part
        if i:
            drive(empty, "location", f"{i} * frame", 0)
    snapshot, _, _ = export_probe.through_engine(moving)
    instances = snapshot["instances"]
    assert instances["knots"].tolist() == [1, 3, 3]
    x = instances["world_from_object"][:, 0, 3]
    assert x == pytest.approx([0, 9.75, 10, 10.25, 19.5, 20, 20.5])
    assert len(snapshot["geometries"]) == 1


def shape_key(thing, name="Up", lift=1.0):
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name=name)
    for point in key.data:
        point.co.z += lift
    return key


def test_shape_keys(moving):
    square = scene_parts.add_square(moving)
    drive(shape_key(square), "value", "frame / 20")
    still = scene_parts.add_square(moving, "Still")
    snapshot, report, _ = export_probe.through_engine(moving)
    points = geometry_of(snapshot, "Square")["points"]
    assert points.shape == (3, 4, 3) and points.flags.c_contiguous
    assert points[:, :, 2] == pytest.approx(np.repeat([[0.4875], [0.5], [0.5125]], 4, axis=1))
    assert geometry_of(snapshot, "Still")["points"].shape == (1, 4, 3)
    assert still.data.vertices[0].co.z == 0.0 and len(report) == 0


def test_a_deformed_cage(moving):
    square = scene_parts.add_square(moving)
    drive(shape_key(square), "value", "frame / 20")
    modifier = square.modifiers.new("Subsurf", "SUBSURF")
    modifier.render_levels = 3
    snapshot, _, _ = export_probe.through_engine(moving)
    geometry = geometry_of(snapshot, "Square")
    assert "subdivision" in geometry and geometry["points"].shape == (3, 4, 3)
    assert geometry["points"][:, 0, 2] == pytest.approx([0.4875, 0.5, 0.5125])


def test_a_moving_subsurf_stays_a_static_cage(moving):
    square = scene_parts.add_square(moving)
    square.modifiers.new("Subsurf", "SUBSURF").render_levels = 2
    drive(square, "location", "frame", 0)
    snapshot, _, _ = export_probe.through_engine(moving)
    assert geometry_of(snapshot, "Square")["points"].shape == (1, 4, 3)
    assert xs(snapshot, "Square") == pytest.approx([9.75, 10, 10.25])


def sphere(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=32)
    return bpy.context.object


def test_deforming_cages_are_not_subdivided_at_every_knot(moving):
    """A million faces would come of it: what a step costs is seen in the mesh that Blender holds."""
    thing = sphere(moving)
    drive(shape_key(thing), "value", "frame / 20")
    thing.modifiers.new("Subsurf", "SUBSURF").render_levels = 2
    vertices = []

    def count(scene, depsgraph):
        mesh = thing.evaluated_get(depsgraph).data
        vertices.append((scene.frame_current + scene.frame_subframe, len(mesh.vertices)))

    def listen(_depsgraph):
        bpy.app.handlers.frame_change_post.append(count)

    def stop(_depsgraph):
        bpy.app.handlers.frame_change_post.remove(count)

    snapshot, _, _ = export_probe.through_engine(moving, before=listen, after=stop)
    cage = len(thing.data.vertices)
    assert vertices == [(9.75, cage), (10.25, cage), (10.0, cage)]
    assert geometry_of(snapshot, "Sphere")["points"].shape == (3, cage, 3)
    # The next render finds the modifier switched on.
    assert "subdivision" in geometry_of(export_probe.through_engine(moving)[0], "Sphere")


@pytest.mark.parametrize("through_collection", [False, True])
def test_a_mesh_that_others_read_stays_subdivided(moving, through_collection):
    """A boolean with a deforming subsurf must see its round form at every knot."""
    thing = sphere(moving)
    drive(shape_key(thing), "value", "frame / 20")
    thing.modifiers.new("Subsurf", "SUBSURF").render_levels = 1
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

    def listen(_depsgraph):
        bpy.app.handlers.frame_change_post.append(count)

    def stop(_depsgraph):
        bpy.app.handlers.frame_change_post.remove(count)

    export_probe.through_engine(moving, before=listen, after=stop)
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
    drive(bone, "rotation_euler", "frame / 5", 0)
    expected = []
    for subframe_of in ((9, 0.75), (10, 0.0), (10, 0.25)):
        moving.frame_set(subframe_of[0], subframe=subframe_of[1])
        evaluated = square.evaluated_get(bpy.context.evaluated_depsgraph_get())
        expected.append([tuple(vertex.co) for vertex in evaluated.data.vertices])
    moving.frame_set(10)
    snapshot, _, _ = export_probe.through_engine(moving)
    assert geometry_of(snapshot, "Square")["points"] == pytest.approx(np.array(expected), abs=1e-6)


def wave_of_nodes(thing):
    """Geometry nodes that lift every point by the scene's time."""
    tree = bpy.data.node_groups.new("Lift", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        for way in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    time = tree.nodes.new("GeometryNodeInputSceneTime")
    vector = tree.nodes.new("ShaderNodeCombineXYZ")
    lift = tree.nodes.new("GeometryNodeSetPosition")
    tree.links.new(time.outputs["Frame"], vector.inputs["Z"])
    tree.links.new(vector.outputs[0], lift.inputs["Offset"])
    tree.links.new(start.outputs[0], lift.inputs["Geometry"])
    tree.links.new(lift.outputs[0], end.inputs[0])
    thing.modifiers.new("Nodes", "NODES").node_group = tree


def test_geometry_nodes_that_ask_for_the_time(moving):
    wave_of_nodes(scene_parts.add_square(moving))
    snapshot, _, _ = export_probe.through_engine(moving)
    points = geometry_of(snapshot, "Square")["points"]
    assert points[:, 0, 2] == pytest.approx([9.75, 10, 10.25])


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
    assert snapshot["geometries"][0]["points"].shape == (3, 4, 3)


def test_deforming_text(moving):
    """A curve's mesh is found again though it is a new one at every knot."""
    bpy.ops.object.text_add()
    drive(bpy.context.object.data, "extrude", "frame / 10")
    snapshot, report, _ = export_probe.through_engine(moving)
    points = geometry_of(snapshot, "Text")["points"]
    assert points[:, :, 2].max(axis=1) == pytest.approx([0.975, 1.0, 1.025])
    assert len(report) == 0


def test_particles_fly(moving):
    """Emitted at frame 1 without gravity, with 2 m/s: a frame of particles lasts .04 s at any rate."""
    emitter = scene_parts.add_square(moving, "Emitter", 1.0)
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    flake = scene_parts.add_square(moving, "Flake", 0.1, (0, 0, -50))
    flake.hide_render = False
    settings = emitter.particle_systems[0].settings
    settings.count, settings.frame_start, settings.frame_end = 5, 1, 1
    settings.lifetime, settings.normal_factor = 1000, 2.0
    settings.effector_weights.gravity = 0.0
    settings.render_type, settings.instance_object = "OBJECT", flake
    settings.particle_size = 1.0
    settings.use_scale_instance = False
    for frame in range(1, 11):
        moving.frame_set(frame)
    snapshot, _, _ = export_probe.through_engine(moving)
    instances = snapshot["instances"]
    first = np.cumsum(instances["knots"]) - instances["knots"]
    flying = [i for i, knots in enumerate(instances["knots"]) if knots == 3]
    assert len(flying) == 5
    for i in flying:
        z = instances["world_from_object"][first[i] : first[i] + 3, 2, 3]
        assert np.diff(z) == pytest.approx([0.25 * 2 * 0.04] * 2, rel=1e-3)


def same(a, b):
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    return np.array_equal(a, b)


def test_persistent_data_changes_nothing(moving):
    square = scene_parts.add_square(moving)
    drive(square, "location", "frame", 0)
    drive(shape_key(square), "value", "frame / 20")
    square.modifiers.new("Subsurf", "SUBSURF").render_levels = 2
    scene_parts.add_square(moving, "Still").modifiers.new("Subsurf", "SUBSURF")

    def frames():
        for frame in (10, 11, 12):
            moving.frame_set(frame)
            yield export_probe.through_engine(moving)[0]

    fresh = list(frames())
    moving.render.use_persistent_data = True
    assert all(same(a, b) for a, b in zip(fresh, frames(), strict=True))
    assert not same(fresh[0], fresh[1])


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
    assert xs(snapshot, "Growing") == pytest.approx([9.75, 9.875, 10, 10.125, 10.25])
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


def test_hidden_within_the_shutter_is_held(moving):
    square = scene_parts.add_square(moving)
    drive(square, "location", "frame", 0)
    drive(square, "hide_render", "frame > 10.1")
    snapshot, _, _ = export_probe.through_engine(moving)
    assert xs(snapshot, "Square") == pytest.approx([9.75, 10, 10])


def test_what_is_hidden_at_the_frame_is_not_there(moving):
    drive(scene_parts.add_square(moving), "hide_render", "frame < 10.1")
    snapshot, _, _ = export_probe.through_engine(moving)
    assert snapshot["instances"]["name"] == []


def test_objects_can_stand_out_of_motion_blur(moving):
    square = scene_parts.add_square(moving)
    if not hasattr(square, "cycles"):
        pytest.skip("Cycles' settings are not there")
    drive(square, "location", "frame", 0)
    drive(shape_key(square), "value", "frame / 20")
    square.cycles.use_deform_motion = False
    snapshot, _, _ = export_probe.through_engine(moving)
    assert len(xs(snapshot, "Square")) == 3
    assert geometry_of(snapshot, "Square")["points"].shape[0] == 1
    square.cycles.use_motion_blur = False
    drive(moving.camera, "location", "frame", 1)
    moving.camera.cycles.use_motion_blur = False
    snapshot, _, _ = export_probe.through_engine(moving)
    assert xs(snapshot, "Square").tolist() == [10.0]
    assert snapshot["camera"]["world_from_camera"][:, 1, 3].tolist() == [10.0]


def test_the_camera_is_taken_at_the_frame_though_a_marker_follows(moving):
    first = moving.camera
    drive(first, "location", "frame", 1)
    second = scene_parts.add_camera(moving, (50, 50, 50))
    second.name = "Second"
    for frame, camera in ((1, first), (11, second)):
        moving.timeline_markers.new(f"F{frame}", frame=frame).camera = camera
    moving.render.motion_blur_shutter = 4.0
    moving.frame_set(10)
    snapshot, _, _ = export_probe.through_engine(moving)
    camera = snapshot["camera"]
    assert camera["name"] == first.name
    assert camera["world_from_camera"][:, 1, 3] == pytest.approx([8, 10, 12])


def test_the_frame_is_restored_after_a_failure(moving):
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    calls = []

    def fail_late():
        # At the second knot the scene stands elsewhere.
        calls.append(moving.frame_current + moving.frame_subframe)
        if calls[-1] != 10.0 and len(set(calls)) > 2:
            raise RuntimeError("on purpose")

    with pytest.raises(RuntimeError, match="on purpose") as caught:
        export_probe.through_engine(moving, cancelled=fail_late)
    assert caught.value.time_after == 10.0
    assert calls[-1] == pytest.approx(10.25)


def test_the_frame_is_restored_after_cancel(moving):
    drive(scene_parts.add_square(moving), "location", "frame", 0)

    def away():
        return moving.frame_current != 10

    with pytest.raises(Cancelled) as caught:
        export_probe.through_engine(moving, cancelled=away)
    assert caught.value.time_after == 10.0


def test_render_at_a_subframe(moving):
    moving.frame_set(10, subframe=0.5)
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    snapshot, _, time_after = export_probe.through_engine(moving)
    assert xs(snapshot, "Square") == pytest.approx([10.25, 10.5, 10.75])
    assert time_after == 10.5


def test_original_data_is_untouched(moving):
    square = scene_parts.add_square(moving)
    modifier = square.modifiers.new("Subsurf", "SUBSURF")
    drive(square, "location", "frame", 0)
    export_probe.through_engine(moving)
    assert modifier.show_render and modifier.show_viewport
    assert len(square.data.vertices) == 4 and len(bpy.data.meshes) == 1
