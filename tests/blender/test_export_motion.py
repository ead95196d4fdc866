# SPDX-License-Identifier: GPL-3.0-or-later
"""Places at the knots of the shutter: objects, parents, instances, the camera."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from export_probe import geometry_of
from motion_parts import drive, on_every_step, set_position, shape_key, with_shutter, xs

from granita.export.motion import shutter_steps


@pytest.fixture
def moving(scene):
    return with_shutter(scene)


@pytest.mark.smoke
@pytest.mark.parametrize(
    "position, expected",
    [("CENTER", [9.75, 10.25]), ("START", [10, 10.5]), ("END", [9.5, 10])],
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
    assert xs(snapshot, "Square") == pytest.approx([9.75, 10.25])
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

    snapshot, _, _ = export_probe.through_engine(moving, **on_every_step(changed))
    assert xs(snapshot, "Square").tolist() == [10.0] and changes == []


@pytest.mark.parametrize("moves, walks", [("NOTHING", 0), ("OBJECT", 0), ("INSTANCER", 2)])
def test_the_scene_is_walked_again_only_for_instances(moving, moves, walks, monkeypatch):
    square = scene_parts.add_square(moving)
    part = bpy.data.collections.new("Part")
    part.objects.link(scene_parts.add_square(moving, "Inside"))
    empty = scene_parts.add_object(moving, "Place", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", part
    if moves != "NOTHING":
        drive(square if moves == "OBJECT" else empty, "location", "frame", 0)
    walked = []
    walk = shutter_steps.visit
    monkeypatch.setattr(shutter_steps, "visit", lambda *all_: walked.append(1) or walk(*all_))
    export_probe.through_engine(moving)
    assert len(walked) == walks


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
    assert xs(snapshot, "Square") == pytest.approx([frame - 0.25, frame + 0.25])
    assert time_after == frame


def test_camera_and_lights_move(moving):
    drive(moving.camera, "location", "frame", 1)
    light = scene_parts.add_object(moving, "Lamp", bpy.data.lights.new("Lamp", "POINT"))
    drive(light, "location", "2 * frame", 2)
    snapshot, _, _ = export_probe.through_engine(moving)
    assert snapshot["camera"]["world_from_camera"][:, 1, 3] == pytest.approx([9.75, 10.25])
    (lamp,) = snapshot["lights"]
    assert lamp["world_from_light"][:, 2, 3] == pytest.approx([19.5, 20.5])


def test_a_zoom_before_the_world_alone_has_the_knots_that_it_needs(moving):
    """The frame's corners go as 1 / sensor."""
    moving.camera.data.lens = 20.0
    drive(moving.camera.data, "sensor_width", "36 + 60 * (frame - 10)")
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    assert len(snapshot["camera"]["world_from_camera"]) == 17


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
    assert xs(snapshot, "Child") == pytest.approx([9.75, 10.25])
    assert xs(snapshot, "Follower") == pytest.approx([-9.75, -10.25])


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
    assert instances["knots"].tolist() == [1, 2, 2]
    x = instances["world_from_object"][:, 0, 3]
    assert x == pytest.approx([0, 9.75, 10.25, 19.5, 20.5])
    assert len(snapshot["geometries"]) == 1


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
    flying = [i for i, knots in enumerate(instances["knots"]) if knots == 2]
    assert len(flying) == 5
    for i in flying:
        z = instances["world_from_object"][first[i] : first[i] + 2, 2, 3]
        assert np.diff(z) == pytest.approx([0.5 * 2 * 0.04], rel=1e-3)


def hide_by_keys(thing, hidden):
    """Args: hidden, {frame: bool}; from each on it is so."""
    for frame, value in hidden.items():
        thing.hide_render = value
        thing.keyframe_insert("hide_render", frame=frame)


def hide_by_strip(thing, hidden):
    hide_by_keys(thing, hidden)
    data = thing.animation_data
    strip = data.nla_tracks.new().strips.new("Strip", 0, data.action)
    if hasattr(strip, "action_slot"):
        strip.action_slot = data.action_slot
    data.action = None


def hide_by_driver(thing, hidden):
    frames = sorted(hidden)
    expression = f"frame < {frames[1]}" if hidden[frames[0]] else f"frame >= {frames[1]}"
    drive(thing, "hide_render", expression)


@pytest.mark.parametrize("hide", [hide_by_keys, hide_by_strip, hide_by_driver])
@pytest.mark.parametrize("hidden", [{0: True, 10: False}, {0: False, 10.1: True}], ids=str)
def test_what_is_shown_at_the_frame_is_shown_for_the_whole_shutter_moving(moving, hide, hidden):
    """Blender does not evaluate what it hides: what appears at the frame, or goes just after it, moves and
    bends as if it had always been there."""
    square = scene_parts.add_square(moving)
    drive(square, "location", "frame", 0)
    drive(shape_key(square), "value", "frame / 20")
    hide(square, hidden)
    moving.frame_set(9)
    moving.frame_set(10)
    snapshot, report, _ = export_probe.through_engine(moving)
    assert xs(snapshot, "Square") == pytest.approx([9.75, 10.25])
    heights = export_probe.geometry_of(snapshot, "Square")["points"][:, 0, 2]
    assert heights == pytest.approx([9.75 / 20, 10.25 / 20])
    assert "lifespan" not in snapshot["instances"]
    assert report.entries() == []


@pytest.mark.parametrize("persistent", [False, True])
def test_its_animation_goes_on_afterwards(moving, persistent):
    square = scene_parts.add_square(moving)
    drive(square, "location", "frame", 0)
    hide_by_keys(square, {0: True, 10: False, 11: True, 12: False})
    seen = export_probe.frame_by_frame(moving, (9, 10, 11, 12), persistent=persistent)
    assert [job.snapshot["instances"]["name"] for job in seen] == [[], ["Square"], [], ["Square"]]
    for data in (
        square.animation_data,
        square.evaluated_get(bpy.context.evaluated_depsgraph_get()).animation_data,
    ):
        assert not any(curve.mute for curve in data.drivers)
    curves = scene_parts.fcurves_of(square)
    assert len(curves) == 1 and not curves[0].mute


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
    assert len(xs(snapshot, "Square")) == 2
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
    assert camera["world_from_camera"][:, 1, 3] == pytest.approx([8, 12])


def test_render_at_a_subframe(moving):
    moving.frame_set(10, subframe=0.5)
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    snapshot, _, time_after = export_probe.through_engine(moving)
    assert xs(snapshot, "Square") == pytest.approx([10.25, 10.75])
    assert time_after == 10.5


def test_an_object_asks_for_more_knots_than_the_scene_allows(moving):
    """Two to the power of its steps, and one: 8 segments where the scene's limit is 2."""
    square = scene_parts.add_square(moving)
    drive(square, "rotation_euler", "40 * frame", 2)
    (getattr(square, "cycles", None) or square.granita).motion_steps = 3
    snapshot, _, _ = export_probe.through_engine(moving)
    turned = export_probe.knots_of(snapshot, "Square")
    angles = 40.0 * np.linspace(9.75, 10.25, 9)
    assert turned[:, 0, 0] == pytest.approx(np.cos(angles), abs=1e-4)


def test_whole_turns_do_not_look_still(moving):
    """Two turns within the shutter: as at the frame at its start, middle and end."""
    square = scene_parts.add_square(moving)
    drive(square, "rotation_euler", f"{8 * np.pi!r} * frame", 2)
    snapshot, _, _ = export_probe.through_engine(moving, motion_steps=17)
    assert len(export_probe.knots_of(snapshot, "Square")) == 17


def test_the_camera_asks_for_more_knots_too(moving):
    camera = moving.camera
    drive(camera, "rotation_euler", "40 * frame", 2)
    (getattr(camera, "cycles", None) or camera.granita).motion_steps = 3
    snapshot, _, _ = export_probe.through_engine(moving)
    assert len(snapshot["camera"]["world_from_camera"]) == 9


def test_a_handler_that_deletes_an_object_leaves_it_where_it_was(moving):
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    scene_parts.add_square(moving, "Doomed", 1.0)

    def delete(*_):
        doomed = bpy.data.objects.get("Doomed")
        if doomed is not None:
            bpy.data.objects.remove(doomed)

    snapshot, _, _ = export_probe.through_engine(moving, **on_every_step(delete))
    assert xs(snapshot, "Square") == pytest.approx([9.75, 10.25])
    assert xs(snapshot, "Doomed").tolist() == [0.0]


@pytest.mark.parametrize("length", [1e-6, 1e6])
def test_extreme_shutters(moving, length):
    moving.render.motion_blur_shutter = length
    drive(scene_parts.add_square(moving), "location", "sin(frame)", 0)
    snapshot, _, time_after = export_probe.through_engine(moving)
    assert np.isfinite(xs(snapshot, "Square")).all() and time_after == 10.0
