# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C where Blender is a Python module.

Python raises KeyboardInterrupt wherever it is just then.  In a handler of Blender's or a callback of a weak reference it
is printed at most, and dropped: the render would go on, and a farm that has asked for its end would wait for all of it.  So what
asks whether to stop asks here as well.  Blender's own program has its own way, and scripts may have theirs: those stay.
"""

import contextlib
import signal

from .handlers import registration

_came = False


def came():
    """Whether there was one since the render began."""
    return _came


def _note(number, frame):
    global _came
    if not _came:  # a second one would end what tells of the first
        _came = True
        signal.default_int_handler(number, frame)


def _listen(*_):
    global _came
    _replace(signal.default_int_handler, _note)
    _came = False  # one that comes before raises, and stays noted


def _leave(*_):
    global _came
    _came = False
    _replace(_note, signal.default_int_handler)


def _replace(old, new):
    if signal.getsignal(signal.SIGINT) is old:
        with contextlib.suppress(ValueError):  # not the main thread: no Ctrl-C comes to it
            signal.signal(signal.SIGINT, new)


register, _remove_handlers = registration(
    ("render_init", _listen), ("render_complete", _leave), ("render_cancel", _leave)
)


def unregister():
    _remove_handlers()
    _leave()
