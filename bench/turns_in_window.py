# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns of everything that begins and ends: the add-on is switched on, a frame rendered, a 3D view drawn, the add-on
switched off.  Runs in a Blender with a window, for starts.py.

    blender --python bench/turns_in_window.py -- JOB.json

JOB: {"file", "turns"}.  The file gets [threads, open files, bytes of the heap] after each turn.
"""

import json
import os
import sys
from pathlib import Path

import addon_utils
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "blender"))
from heap import heap_bytes  # noqa: E402

JOB = json.loads(Path(sys.argv[-1]).read_text())
DRAWN = 0.4  # seconds of a view


def held():
    return [len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd")), heap_bytes()]


def steps():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    scene, shading, curve = window.scene, area.spaces.active.shading, []
    bpy.context.preferences.edit.undo_steps = 2
    bpy.context.preferences.view.render_display_type = "NONE"
    scene.render.resolution_x = scene.render.resolution_y = 32
    for _ in range(JOB["turns"]):
        addon_utils.enable("granita")
        scene.render.engine = "GRANITA"
        scene.granita.samples = 4
        with bpy.context.temp_override(window=window, screen=window.screen, scene=scene):
            bpy.ops.render.render()
        shading.type = "RENDERED"
        yield DRAWN
        shading.type = "SOLID"
        yield 0.1
        scene.render.engine = "BLENDER_WORKBENCH"
        addon_utils.disable("granita")
        yield 0.05
        curve.append(held())
    Path(JOB["file"]).write_text(json.dumps(curve))
    os._exit(0)


def step():
    try:
        return next(todo)
    except Exception:
        sys.excepthook(*sys.exc_info())
        os._exit(1)


todo = steps()
bpy.app.timers.register(step, first_interval=1.0)
