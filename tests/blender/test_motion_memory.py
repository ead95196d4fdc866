# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory over many frames: nothing of a frame stays when it is exported."""

import export_probe
import numpy as np
import pytest
import scene_parts
from heap import heap_bytes
from motion_parts import drive, shape_key, with_shutter

FRAMES, WARM_UP = 300, 50


@pytest.mark.parametrize("persistent", [False, True])
def test_export_of_300_frames_is_flat(scene, persistent):
    """A moving and deforming object and a moving instance: less than 20 KB a frame by regression."""
    if heap_bytes() is None:
        pytest.skip("the heap of this Blender cannot be asked")
    with_shutter(scene)
    square = scene_parts.add_square(scene)
    drive(square, "rotation_euler", "frame", 2)
    drive(shape_key(square), "value", "frame / 300")
    part = scene_parts.bpy.data.collections.new("Part")
    part.objects.link(square)
    empty = scene_parts.add_object(scene, "Place", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", part
    drive(empty, "location", "frame", 0)
    bytes_used = []
    frames = range(1, FRAMES + 1)
    for _ in export_probe.frame_by_frame(scene, frames, persistent=persistent, motion_steps=5):
        bytes_used.append(heap_bytes())
    slope = np.polyfit(np.arange(FRAMES - WARM_UP), bytes_used[WARM_UP:], 1)[0]
    print(f"heap: {slope:.0f} bytes a frame")
    assert slope < 20e3
