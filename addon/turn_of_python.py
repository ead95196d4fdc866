# SPDX-License-Identifier: GPL-3.0-or-later
"""A render begins between two calls of Python by Blender's window, not in the middle of one.

Blender keeps in one place for all threads whether scripts may write now (`rna_disallow_writes`).  Each call of a class
puts that back, at its end, as it found it.  A render that began while a panel or a view was drawn, which may not write,
and ended later left it so: no timer and no handler could write any more until Blender ended.  So its thread waits where
no class is called: in handlers, and where an engine is made.
"""

import sys
import threading
import time

from .handlers import registration

_INTERVAL = sys.getswitchinterval()
# Seconds: for longer no call is waited for.  So long is none that draws.
_PATIENCE = 10.0


def await_start():
    """In the render's thread, before Blender calls it: until the window's own is not within Python.  From now on a
    thread gets its turn when another one has ended its call."""
    window = threading.main_thread()
    if threading.current_thread() is window:
        return
    sys.setswitchinterval(_PATIENCE)
    end = time.monotonic() + _PATIENCE
    while window.ident in sys._current_frames() and time.monotonic() < end:
        time.sleep(0.0005)  # which lets it go on


def started(*_):
    """The render has been called, or will not be: turns are as short as ever."""
    sys.setswitchinterval(_INTERVAL)


def _frame_begins(scene, *_):
    if scene.render.engine == "GRANITA":
        await_start()


register, unregister = registration(
    ("render_pre", _frame_begins),
    ("render_post", started),
    ("render_cancel", started),
    ("render_complete", started),
)
