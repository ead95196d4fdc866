# SPDX-License-Identifier: GPL-3.0-or-later
"""Export leaves Blender as it was: the frame, the modifiers, what is kept between frames."""

import bpy
import export_probe
import pytest
import scene_parts
from motion_parts import drive, with_shutter

from granita.export import Cancelled


@pytest.fixture
def moving(scene):
    return with_shutter(scene)


def test_the_frame_is_restored_after_a_failure(moving):
    drive(scene_parts.add_square(moving), "location", "frame", 0)
    calls = []

    def fail_late(_wanted):
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

    def away(_wanted):
        return moving.frame_current != 10

    with pytest.raises(Cancelled) as caught:
        export_probe.through_engine(moving, cancelled=away)
    assert caught.value.time_after == 10.0


def test_original_data_is_untouched(moving):
    square = scene_parts.add_square(moving)
    modifier = scene_parts.add_subsurf(square)
    drive(square, "location", "frame", 0)
    export_probe.through_engine(moving)
    assert modifier.show_render and modifier.show_viewport
    assert len(square.data.vertices) == 4 and len(bpy.data.meshes) == 1
