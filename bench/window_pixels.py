# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels of a virtual screen, read while a program draws on it: Xvfb maps them into a file."""

import mmap
import shutil
import struct
import subprocess
import tempfile
import threading
import time
import zlib
from pathlib import Path

import numpy as np


class Screen:
    """An Xvfb of its own.  `with Screen(1024, 768) as screen: ... screen.name`."""

    def __init__(self, width, height):
        self._size = width, height

    def __enter__(self):
        self._folder = Path(tempfile.mkdtemp(prefix="granita-screen-"))
        width, height = self._size
        self._server = subprocess.Popen(
            ["Xvfb", "-displayfd", "1", "-nolisten", "tcp", "-fbdir", str(self._folder)]
            + ["-screen", "0", f"{width}x{height}x24"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        self.name = ":" + self._server.stdout.readline().decode().strip()
        self._file = (self._folder / "Xvfb_screen0").open("r+b")
        self._map = mmap.mmap(self._file.fileno(), 0, access=mmap.ACCESS_READ)
        header = struct.unpack(">25I", self._map[:100])
        begin = header[0] + header[19] * 12  # X window dump: header, colour map, pixels
        row = header[12]
        flat = np.frombuffer(self._map, dtype=np.uint8, count=row * height, offset=begin)
        self._pixels = flat.reshape(height, row)[:, : width * 4].reshape(height, width, 4)
        return self

    def __exit__(self, *_):
        self._pixels = None
        self._server.terminate()
        self._server.wait()
        shutil.rmtree(self._folder, ignore_errors=True)

    def pixels(self, box=None):
        """uint8 [h, w, 4] blue, green, red, _; top row first.  `box`: (x0, y0, x1, y1) from the top."""
        x0, y0, x1, y1 = box or (0, 0, *self._size)
        return self._pixels[y0:y1, x0:x1].copy()

    def words(self, box):
        """uint32 [h, w]: the pixels themselves, as they change."""
        x0, y0, x1, y1 = box
        return self._pixels.view(np.uint32)[y0:y1, x0:x1, 0]


class Watch(threading.Thread):
    """Notes when a box of a screen changed: `changes` is [(monotonic seconds, crc)].

    Of each few rows one is looked at: all of them 200 times a second cost half a core, which what is watched wants.
    """

    SECONDS = 0.005
    ROWS = 8

    def __init__(self, screen, box):
        super().__init__(daemon=True)
        self._screen, self._box = screen, box
        self._ends = threading.Event()
        self.changes = []

    def run(self):
        rows, last = self._screen.words(self._box)[:: self.ROWS], None
        while not self._ends.wait(self.SECONDS):
            if last is None or not np.array_equal(rows, last):
                last = rows.copy()
                self.changes.append((time.monotonic(), zlib.crc32(last)))

    def end(self):
        self._ends.set()
        self.join()
