# SPDX-License-Identifier: GPL-3.0-or-later
"""How a frame is cut into parts: by place, or as a coarse look at it has said.

What the look says is a part file without pixels, part 0 of N: it lies where the parts will, so that all machines
cut in the same way.
"""

from dataclasses import dataclass
from pathlib import Path

from . import part_file
from .collected_part import CollectedPart
from .rectangles import split

CUT = 0


@dataclass
class FrameCut:
    """Of one view layer of one frame."""

    folder: Path
    origin: dict  # what the headers of its files say of where the picture comes from
    crop: tuple  # (x0, y0, x1, y1), what the frame renders
    tile: int

    def part(self, part, passes):
        """A CollectedPart; `part` (k, n); `passes` [(name, channels)].  Raises PartError."""
        k, n = part
        about = self.origin["frame"], self.origin["layer"]
        rect = rectangles(self.folder, *about, n, self.crop, self.tile)[k - 1]
        path = self.folder / part_file.file_name(*about, part)
        return CollectedPart(path, part, rect, self.crop, passes, self.origin)

    def write(self, count, costs):
        """Cuts it into `count` parts of about the same cost (rectangles.split).  Raises PartError."""
        rects = split(self.crop, count, self.tile, costs)
        path = _path(self.folder, self.origin["frame"], self.origin["layer"], count)
        about = {**self.origin, "rects": [rect and list(rect) for rect in rects]}
        CollectedPart(path, (CUT, count), None, self.crop, [], about).write()


def rectangles(folder, frame, layer, count, crop, tile):
    """The parts of `crop` in turn: (x0, y0, x1, y1), None where nothing is left for one.  Raises PartError."""
    path = _path(folder, frame, layer, count)
    if not path.exists():
        return split(crop, count, tile)
    header = part_file.read(path).header
    if header["crop"] != list(crop):
        raise part_file.PartError(
            f"'{path}' cuts a frame of another size or border: look again, or remove it"
        )
    return [rect and tuple(rect) for rect in header["rects"]]


def _path(folder, frame, layer, count):
    return Path(folder) / part_file.file_name(frame, layer, (CUT, count))
