# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of one view layer of one frame, checked against it and against one another."""

from pathlib import Path

from .frame_cut import rectangles
from .part_file import PartError, file_name, read

# What has to be the same in all parts, and how it is called where it is not.  The first one that
# differs explains the others: another version of Granita may well read a scene differently.
_COMMON = (
    ("granita", "was rendered by another version of Granita"),
    ("build", "was rendered by another build of Granita"),
    ("blender", "was rendered in another version of Blender"),
    ("picture", "is of another state of the scene or its settings"),
)


def read_parts(folder, frame, layer, count, crop, tile, passes):
    """All parts in turn, each a Part that fits the frame and those before it.

    Args:
        frame, layer: number and name.
        crop: (x0, y0, x1, y1), what the frame renders.
        passes: [(name, channels)] that each part has to have.

    Raises:
        PartError: names the first part that is missing, damaged or of something else.
    """
    paths = [Path(folder) / file_name(frame, layer, (k, count)) for k in range(1, count + 1)]
    headers = [read(path).header for path in paths]
    # The latest is what was meant: those that differ from it were left over.
    latest = max(headers, key=lambda header: header["written"])
    rects = rectangles(folder, frame, layer, count, crop, tile)
    for path, header, rect in zip(paths, headers, rects, strict=True):
        what = f"part file '{path}'"
        for key, complaint in _COMMON:
            if header[key] != latest[key]:
                raise PartError(
                    f"{what} {complaint} than the latest part ({header['written']}, the latest "
                    f"{latest['written']}): render this part again"
                )
        if header["crop"] != list(crop) or header["rect"] != (rect and list(rect)):
            raise PartError(
                f"{what} is of a frame of another size or border, or cut in another way"
            )
        had = [(name, channels) for name, channels in header["passes"]]
        if rect and had != list(passes):
            raise PartError(f"{what} has other passes than the view layer asks for now: {had}")
    for path, rect in zip(paths, rects, strict=True):
        if rect:
            yield read(path)
