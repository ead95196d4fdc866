# SPDX-License-Identifier: GPL-3.0-or-later
"""A part while it is rendered: finished tiles are laid into arrays, which then are written."""

from datetime import datetime, timezone

import numpy as np

from . import part_file
from .part_file import PartError


class CollectedPart:
    def __init__(self, path, part, rect, crop, passes, origin):
        """`part` (k, n); `rect`: its pixels, None where nothing is left for it; `passes`
        [(name, channels)]; `origin`: what the header says of where the picture comes from."""
        self.path = path
        self.rect = rect
        self._header = {
            "part": list(part),
            "rect": rect and list(rect),
            "crop": list(crop),
            **origin,
        }
        x0, y0, x1, y1 = rect or (0, 0, 0, 0)
        self._values = {
            name: np.zeros((y1 - y0, x1 - x0, channels), np.float32) for name, channels in passes
        }
        self._filled = np.zeros((y1 - y0, x1 - x0), bool)

    def add(self, tile, arrays):
        """`arrays`: {pass: [height, width(, channels)]} of the tile, as the native library made them."""
        height, width = tile.combined.shape[:2]
        x, y = tile.x - self.rect[0], tile.y - self.rect[1]
        place = np.s_[y : y + height, x : x + width]
        for name, values in self._values.items():
            values[place] = np.reshape(arrays[name], (height, width, -1))
        self._filled[place] = True

    def write(self):
        """Raises PartError."""
        if not self._filled.all():
            raise PartError(f"part file '{self.path}' is not written: pixels are missing")
        written = datetime.now(timezone.utc).isoformat(timespec="milliseconds")
        part_file.write(self.path, {**self._header, "written": written}, self._values)
