# SPDX-License-Identifier: GPL-3.0-or-later
"""A render begins between two calls of Python by Blender's window, not in the middle of one.

Blender keeps in one place for all threads whether scripts may write now (`rna_disallow_writes`).  Each call of a class
puts that back, at its end, as it found it.  A render that began while a panel or a view was drawn, which may not write,
and ended later left it so: no timer and no handler could write any more until Blender ended.  So its thread waits where
no class is called, in a handler: of the frame, and, for view layers after the first, of the evaluation that goes before
each.  A preview, which has none, is given up where it would do that.
"""

import sys
import threading
import time

import bpy

from .handlers import registration

_INTERVAL = sys.getswitchinterval()
# Seconds: for longer no call is waited for.  So long is none that draws.
_PATIENCE = 10.0
# Seconds for which a thread keeps Python: more than a call that draws takes, and for no longer do threads of others stand
# still.
_TURN = 1.0
# How functions that draw are called, and what Blender asks while it draws.
_MAY_NOT_WRITE = ("draw", "view_draw", "poll", "filter_items")
_between_layers = False


def await_start():
    """In the render's thread, before Blender calls it: until the window's own is not within Python."""
    await_turn()
    end = time.monotonic() + _PATIENCE
    while _frame_of_window() is not None and time.monotonic() < end:
        time.sleep(0.0005)  # which lets it go on


def await_turn():
    """From now on the render's thread gets its turn when the window's has ended its call."""
    if not bpy.app.background and threading.current_thread() is not threading.main_thread():
        sys.setswitchinterval(_TURN)


def interrupts_drawing():
    """Whether the window's thread is in the middle of a call that may not write."""
    frame = _frame_of_window()
    while frame is not None and frame.f_back is not None:
        frame = frame.f_back
    return frame is not None and frame.f_code.co_name.startswith(_MAY_NOT_WRITE)


def _frame_of_window():
    """Of what it runs of Python; None where that is nothing, or where it is this thread itself."""
    window = threading.main_thread()
    if threading.current_thread() is window:
        return None
    return sys._current_frames().get(window.ident)


def started(*_):
    """The render has been called, or will not be: turns are as short as ever."""
    global _between_layers
    _between_layers = False
    sys.setswitchinterval(_INTERVAL)


def ended():
    """The call of a view layer's render ends; that of another may follow."""
    global _between_layers
    _between_layers = True


def _frame_begins(scene, *_):
    if scene.render.engine == "GRANITA":
        await_start()


def _layer_begins(scene, *_):
    """Not at frames that the window goes to, nor at those that an export looks at within the call."""
    if threading.current_thread() is threading.main_thread():
        return
    if scene.render.engine != "GRANITA":
        started()  # a scene of the compositor's, whose engine does not tell
    elif _between_layers:
        await_start()


def _go_last(*_):
    """Handlers of others that were added meanwhile run with turns as short as ever."""
    for event, function in (("render_pre", _frame_begins), ("frame_change_post", _layer_begins)):
        handlers = getattr(bpy.app.handlers, event)
        if handlers[-1] is not function:
            handlers.remove(function)
            handlers.append(function)


_HANDLERS = (
    ("render_init", _go_last),
    # Until those of others are done: an engine that is made asks for its turn.
    ("render_pre", started),
    ("render_pre", _frame_begins),
    ("frame_change_post", _layer_begins),
    ("render_post", started),
    ("render_cancel", started),
    ("render_complete", started),
)
# Without a window nothing draws.
register, unregister = registration(*(() if bpy.app.background else _HANDLERS))
