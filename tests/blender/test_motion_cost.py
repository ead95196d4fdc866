# SPDX-License-Identifier: GPL-3.0-or-later
"""What export of motion reads: nothing of static things a step; steps are taken where paths bend.

Seconds are in bench/export_cost.py.
"""

import math

import bpy
import export_probe
import pytest
import scene_parts
from call_counts import count_calls
from hair_parts import furry
from motion_parts import drive, on_every_step, open_shutter, with_shutter

from granita.export.geometry import hair_points
from granita.export.motion import shutter_steps
from granita.export.scene import plain_objects


def crowd(scene, count):
    """Static objects of one mesh, and one that turns."""
    mesh = scene_parts.add_square(scene, "First").data
    for i in range(count):
        scene_parts.add_object(scene, f"Still{i}", mesh, (i % 40, i // 40, 0))
    turning = scene_parts.add_square(scene, "Turning", 4.0)
    drive(turning, "rotation_euler", "3 * frame", 2)


@pytest.mark.parametrize("count", [10, 1000])
def test_static_objects_are_read_at_no_step(scene, monkeypatch, count):
    """Of however many: a step reads the place of the one that turns, and walks over nothing."""
    read = count_calls(
        monkeypatch, places=(plain_objects, "from_matrix"), walks=(shutter_steps, "visit")
    )
    crowd(with_shutter(scene), count)
    snapshot, _, _ = export_probe.through_engine(scene, motion_steps=17)
    assert sorted(set(snapshot["instances"]["knots"].tolist())) == [1, 17]
    assert read == {"places": 16, "walks": 0}  # the seventeenth is the frame's own


def test_what_turns_near_the_camera_has_the_knots_that_its_chords_need(scene):
    """A cube of two metres turns by .3 about the view, three metres before the camera.  Its corners lie within
    sqrt(2) metres of its axis: chords of an N-th of the turn leave a corner's way by sqrt(2) (.3 / N)^2 / 8
    metres, 1/32 pixel at most with the eighth (nor does the sum of the box's sides, 2 instead of sqrt(2), ask
    for more).  A ball about the cube would reach the camera, where a metre is any number of pixels.
    """
    open_shutter(scene, 0.5)
    scene_parts.add_camera(scene, (0, 0, 3))
    scene.render.resolution_x = scene.render.resolution_y = 100
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    drive(bpy.context.object, "rotation_euler", ".3 * (frame - 10) / .5", 2)
    snapshot, _, _ = export_probe.through_engine(scene, motion_steps=17)
    pixels = 100 * 50 / 36 / (3 - 1)
    segments = math.sqrt(math.sqrt(2) * 0.3**2 / 8 * pixels * 32)
    assert 4 < segments <= 8
    assert snapshot["instances"]["knots"].tolist() == [9]


def test_flat_things_have_the_knots_of_a_height_that_pulses(scene):
    """They may be displaced, or as thick as their radius, of which their points tell nothing."""
    with_shutter(scene)
    drive(scene_parts.add_square(scene, size=8.0), "scale", "1 + 4 * abs(frame - 10)", 2)
    snapshot, _, _ = export_probe.through_engine(scene, motion_steps=17)
    assert snapshot["instances"]["knots"].tolist() == [3]


def test_straight_movers_take_four_steps_of_time_and_the_way_back(scene):
    with_shutter(scene)
    drive(scene_parts.add_square(scene), "location", "frame", 0)
    times = []

    def note(scene, *_):
        times.append(scene.frame_current + scene.frame_subframe)

    export_probe.through_engine(scene, motion_steps=17, **on_every_step(note))
    assert times == [9.75, 9.875, 10.125, 10.25, 10.0]


def test_hair_that_goes_along_is_asked_for_two_points_a_hair_and_nothing_is_walked(
    scene, monkeypatch
):
    read = count_calls(monkeypatch, walks=(shutter_steps, "visit"))
    asked = []

    def note(*arguments):
        asked.append(arguments[-1])
        return in_world(*arguments)

    in_world = hair_points._world
    monkeypatch.setattr(hair_points, "_world", note)
    with_shutter(scene)
    drive(furry(scene, count=60), "location", "frame", 0)
    export_probe.through_engine(scene, motion_steps=17)
    assert asked == [60 * 9, *[60 * 2] * 4]
    assert read == {"walks": 0}
