# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys that are pressed for a window of X11, as a hand does: Blender's simulated events do not stop a render."""

import ctypes

ESCAPE, F12, CONTROL = 0xFF1B, 0xFFC9, 0xFFE3  # keysymdef.h


class Keyboard:
    """Of the display that $DISPLAY names.  Raises OSError without libXtst."""

    def __init__(self):
        self._x, self._test = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
        self._x.XOpenDisplay.restype = ctypes.c_void_p
        self._display = ctypes.c_void_p(self._x.XOpenDisplay(None))

    def point(self, x, y):
        """Moves the pointer there, pixels: without a window manager what lies under it has the keys."""
        self._test.XTestFakeMotionEvent(self._display, -1, x, y, 0)
        self._x.XFlush(self._display)

    def press(self, *keys):
        """All at once, as Ctrl+F12."""
        codes = [self._x.XKeysymToKeycode(self._display, ctypes.c_ulong(key)) for key in keys]
        for code in codes:
            self._test.XTestFakeKeyEvent(self._display, code, 1, 0)
        for code in reversed(codes):
            self._test.XTestFakeKeyEvent(self._display, code, 0, 0)
        self._x.XFlush(self._display)
