# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the open file's animation by Ctrl+F12 and stops it by Esc.  Runs in a Blender with a window, for cancels.py.

    blender FILE -o OUT --python bench/escaped_render.py -- SECONDS

SECONDS: from the first frame to Esc.  Ends with 1, as Blender does after a job that was stopped, or with 3 where it does not
tell of a cancelled render.
"""

import os
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "blender"))
from keyboard import CONTROL, ESCAPE, F12, Keyboard  # noqa: E402

SECONDS = float(sys.argv[-1])
PATIENCE = 60.0
told = set()
for kind in ("render_write", "render_cancel", "render_complete"):
    getattr(bpy.app.handlers, kind).append(lambda *_, kind=kind: told.add(kind))


def until(is_over):
    end = time.monotonic() + PATIENCE
    while not is_over() and time.monotonic() < end:
        yield 0.02


def steps():
    bpy.context.preferences.view.render_display_type = "NONE"
    keyboard = Keyboard()
    keyboard.point(300, 300)
    yield 0.3
    keyboard.press(CONTROL, F12)
    yield from until(lambda: "render_write" in told)
    yield SECONDS
    keyboard.press(ESCAPE)
    yield from until(lambda: not bpy.app.is_job_running("RENDER"))
    if "render_cancel" not in told or "render_complete" in told:
        os._exit(3)
    bpy.ops.wm.quit_blender()


todo = steps()
bpy.app.timers.register(lambda: next(todo, None), first_interval=0.5)
