# SPDX-License-Identifier: GPL-3.0-or-later
"""A coarse look at a frame: about what each of its tiles costs.

The frame is rendered at a quarter of its size, with a quarter of the samples and micropolygons of twice the edge:
a sixty-fourth of hiding and shading, and once what every part does again (opening, what rays trace).
"""

import numpy as np

SHRINK = 4
# Of the mean: the least that a tile costs, whatever the clock says.
FLOOR = 0.1


def coarse(snapshot, tile):
    """The scene snapshot of the look, which shares the arrays of `snapshot`."""
    options, camera = snapshot["options"], snapshot["camera"]
    x0, y0, x1, y1 = (int(pixel) for pixel in options["crop"])
    look = {key: value for key, value in options.items() if key not in ("passes", "aovs")}
    look |= {
        "width": -(-options["width"] // SHRINK),
        "height": -(-options["height"] // SHRINK),
        "crop": np.array(
            [x0 // SHRINK, y0 // SHRINK, -(-x1 // SHRINK), -(-y1 // SHRINK)], np.int32
        ),
        "samples": max(options["samples"] // SHRINK, 1),
        "dicing_rate": 2.0 * options["dicing_rate"],
        "bucket_size": tile,
        "device": "CPU",
        "depth_pass": False,
    }
    smaller = {key: tuple(value / SHRINK for value in camera[key]) for key in ("scale", "center")}
    return {**snapshot, "options": look, "camera": {**camera, **smaller}}


def tile_costs(buckets, crop, tile):
    """float64 [rows, columns] for the tiles of `crop`, lowest first, of the look's
    `buckets` [(x0, y0, x1, y1, seconds)]."""
    x0, y0 = crop[0] // tile, crop[1] // tile
    costs = np.zeros((-(-crop[3] // tile) - y0, -(-crop[2] // tile) - x0))
    for left, low, right, high, seconds in buckets:
        # Some are cut to the pixels that filters reach: what a whole one would have taken.
        share = seconds / ((right - left) * (high - low))
        column, row = left // tile * SHRINK - x0, low // tile * SHRINK - y0
        place = np.s_[max(row, 0) : max(row + SHRINK, 0), max(column, 0) : max(column + SHRINK, 0)]
        costs[place] = share
    return np.maximum(costs, FLOOR * costs.mean())
