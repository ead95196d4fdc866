# SPDX-License-Identifier: GPL-3.0-or-later
"""What export of motion reads: nothing of static things a step; steps are taken where paths bend.

Seconds are in bench/export_cost.py.
"""

import export_probe
import pytest
import scene_parts
from call_counts import count_calls
from hair_parts import furry
from motion_parts import drive, on_every_step, with_shutter

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
