# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene and a Blender for farms that run on this machine (`./dev test --farm`)."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/blender"))

SCENE = """
import sys
sys.path[:0] = [{tests!r}]
import bpy, scene_parts
scene = bpy.context.scene
bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
scene = bpy.context.scene
scene.render.engine = "GRANITA"
scene.render.resolution_x, scene.render.resolution_y = {width}, {width} * 3 // 4
scene.granita.samples = {samples}
scene.frame_end = 3
scene_parts.add_camera(scene, ortho_scale=4.0)
square = scene_parts.add_square(scene, material=scene_parts.emission("Glow", (0.25, 0.5, 0.75)))
for frame, x in ((0, -1.0), (4, 1.0)):
    square.location.x = x
    square.keyframe_insert("location", frame=frame)
scene.render.use_motion_blur = True
scene_parts.multilayer_exr(scene)
bpy.ops.wm.save_as_mainfile(filepath={path!r})
"""


@pytest.fixture(scope="session")
def blender(tmp_path_factory):
    """A program that takes Blender's arguments and has this tree's add-on."""
    program = tmp_path_factory.mktemp("bin") / "blender"
    program.write_text(f'#!/bin/sh\nexec "{ROOT}/dev" blender --factory-startup "$@"\n')
    program.chmod(0o755)
    return program


def make_scene(blender, path, samples, width):
    code = SCENE.format(
        tests=str(ROOT / "tests/blender"), samples=samples, width=width, path=str(path)
    )
    done = subprocess.run(
        [blender, "-b", "--python-exit-code", "1", "--python-expr", code],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        env=os.environ | {"GRANITA_SKIP_INSTALL": "1"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return path


@pytest.fixture(scope="session")
def scene(blender, tmp_path_factory):
    """Three small frames."""
    return make_scene(blender, tmp_path_factory.mktemp("scene") / "scene.blend", 16, 160)


@pytest.fixture(scope="session")
def slow_scene(blender, tmp_path_factory):
    """A frame of many minutes."""
    return make_scene(blender, tmp_path_factory.mktemp("slow") / "slow.blend", 4096, 640)
