# SPDX-License-Identifier: GPL-3.0-or-later
"""What export of motion costs: static things cost nothing a step; steps are taken where paths bend."""

import time

import export_probe
import scene_parts
from motion_parts import drive, on_every_step, with_shutter


def crowd(scene, count):
    """Static objects of one mesh, and one that turns."""
    mesh = scene_parts.add_square(scene, "First").data
    for i in range(count):
        scene_parts.add_object(scene, f"Still{i}", mesh, (i % 40, i // 40, 0))
    turning = scene_parts.add_square(scene, "Turning", 4.0)
    drive(turning, "rotation_euler", "3 * frame", 2)


def seconds(scene, all_steps):
    """{steps: seconds} of this thread's own time, so that other programs do not count; the best of
    turns that take each number of steps once."""
    best = dict.fromkeys(all_steps, 1e9)
    for _ in range(6):
        for steps in all_steps:
            started = time.thread_time()
            export_probe.through_engine(scene, motion_steps=steps)
            best[steps] = min(best[steps], time.thread_time() - started)
    return best


def test_static_objects_cost_nothing_a_step(scene):
    """Seventeen knots instead of three, of 1,000 objects: at most 1.3 times the export."""
    crowd(with_shutter(scene), 1000)
    snapshot, _, _ = export_probe.through_engine(scene, motion_steps=17)
    assert sorted(set(snapshot["instances"]["knots"].tolist())) == [1, 17]
    few, many = seconds(scene, (3, 17)).values()
    print(f"export of 1,000 objects: {few:.3f} s with 3 knots, {many:.3f} s with 17")
    assert many <= 1.3 * few


def test_straight_movers_take_four_steps_of_time_and_the_way_back(scene):
    with_shutter(scene)
    drive(scene_parts.add_square(scene), "location", "frame", 0)
    times = []

    def note(scene, *_):
        times.append(scene.frame_current + scene.frame_subframe)

    export_probe.through_engine(scene, motion_steps=17, **on_every_step(note))
    assert times == [9.75, 9.875, 10.125, 10.25, 10.0]
