# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame's rectangle in N parts, the same wherever it is cut."""

import numpy as np


def split(crop, count, tile, costs=None):
    """`count` rectangles (x0, y0, x1, y1) that tile `crop`, of whole tiles of the frame.

    The longer side is halved again and again: parts are as square as can be, so that few pixels of the
    filter's margin are sampled twice.  Where there are fewer tiles than parts, the last parts are
    None.  `costs` [rows, columns]: what each tile of the crop costs, halved instead of the place.
    """
    x0, y0, x1, y1 = crop
    tiles = (x0 // tile, y0 // tile, -(-x1 // tile), -(-y1 // tile))
    width, height = tiles[2] - tiles[0], tiles[3] - tiles[1]
    if costs is None:
        costs = np.ones((height, width))
    cells = [
        (tiles[0] + cell[0], tiles[1] + cell[1], tiles[0] + cell[2], tiles[1] + cell[3])
        for cell in _halve((0, 0, width, height), min(count, width * height), costs)
    ]
    parts = [
        (
            max(cell[0] * tile, x0),
            max(cell[1] * tile, y0),
            min(cell[2] * tile, x1),
            min(cell[3] * tile, y1),
        )
        for cell in cells
    ]
    return parts + [None] * (count - len(parts))


def _halve(cell, count, costs):
    """At most as many parts as the cell has tiles."""
    if count == 1:
        return [cell]
    x0, y0, x1, y1 = cell
    width, height = x1 - x0, y1 - y0
    first = count // 2
    along, across = (width, height) if width > height else (height, width)
    # Each side has to hold its own number of parts.
    least, most = -(-first // across), along - -(-(count - first) // across)
    sums = np.cumsum(costs[y0:y1, x0:x1].sum(axis=0 if width > height else 1))
    # Behind the strip with which the first parts' share is reached as nearly as can be.
    nearest = 1 + int(np.argmin(np.abs(sums - sums[-1] * first / count)))
    cut = min(max(nearest, least), most)
    if width > height:
        sides = (x0, y0, x0 + cut, y1), (x0 + cut, y0, x1, y1)
    else:
        sides = (x0, y0, x1, y0 + cut), (x0, y0 + cut, x1, y1)
    return _halve(sides[0], first, costs) + _halve(sides[1], count - first, costs)
