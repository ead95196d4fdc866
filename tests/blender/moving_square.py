# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves a file of a glowing square that moves, float output: what farms and benches render in Blenders of their own.

blender -b --factory-startup --addons granita --python moving_square.py -- FILE WIDTH SAMPLES FRAMES
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import scene_parts  # noqa: E402


def save(file, width, samples, frames):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "GRANITA"
    scene.render.resolution_x, scene.render.resolution_y = width, width * 3 // 4
    scene.granita.samples, scene.granita.bounces = samples, "NONE"
    scene.frame_end = frames
    scene_parts.add_camera(scene, ortho_scale=4.0)
    glow = scene_parts.emission("Glow", (0.25, 0.5, 0.75))
    square = scene_parts.add_square(scene, material=glow)
    for frame, x in ((0, -1.0), (frames + 1, 1.0)):
        square.location.x = x
        square.keyframe_insert("location", frame=frame)
    scene.render.use_motion_blur = True
    scene_parts.multilayer_exr(scene)
    bpy.ops.wm.save_as_mainfile(filepath=file)


file, *numbers = sys.argv[sys.argv.index("--") + 1 :]
save(file, *map(int, numbers))
