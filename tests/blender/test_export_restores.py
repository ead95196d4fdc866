# SPDX-License-Identifier: GPL-3.0-or-later
"""Export leaves Blender as it was: the frame, the modifiers, what is kept between frames."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from motion_parts import drive, shape_key, with_shutter

from granita.export import Cancelled


@pytest.fixture
def moving(scene):
    return with_shutter(scene)


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


def test_original_data_is_untouched(moving):
    square = scene_parts.add_square(moving)
    modifier = square.modifiers.new("Subsurf", "SUBSURF")
    drive(square, "location", "frame", 0)
    export_probe.through_engine(moving)
    assert modifier.show_render and modifier.show_viewport
    assert len(square.data.vertices) == 4 and len(bpy.data.meshes) == 1


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
