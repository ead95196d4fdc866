# SPDX-License-Identifier: GPL-3.0-or-later
"""What bounces is shared with the grids around: their borders do not show, wherever they lie."""

import numpy as np
import pytest
import snapshots as s
from test_shared_world import beside_a_wall

#: Micropolygons of grids of 4 x 4 and of 16 x 16.
SMALL, LARGE = 16, 256


def floor(seed=0, **options):
    """Of the floor all that lies far from the wall and the picture's rim."""
    picture = s.render(beside_a_wall(wall=0.5, light_samples=4, seed=seed, **options))
    return picture["combined"][8:56, 36:56, 0]


def noise(grid_size):
    pairs = [[floor(seed, grid_size=grid_size) for seed in (2 * i, 2 * i + 1)] for i in range(4)]
    return np.sqrt(np.mean([(a - b) ** 2 / 2 for a, b in pairs]))


def test_small_grids_are_no_noisier_than_large_ones():
    """.0032 and .0029; each grid by itself .0066 and .0036."""
    assert noise(SMALL) < 1.3 * noise(LARGE)


@pytest.mark.parametrize("options", [{"bucket_size": 16}, {"threads": 1}])
def test_bits_are_the_same_whichever_bucket_asks(options):
    assert np.array_equal(floor(**options), floor())


def test_a_crop_knows_what_lies_beyond_it():
    def snapshot():
        return beside_a_wall(wall=0.5, light_samples=4)

    whole = s.render(snapshot())["combined"]
    cropped = snapshot()
    cropped["options"]["crop"] = (20, 12, 52, 44)
    part = s.render(cropped)["combined"]
    assert np.array_equal(part, whole[12:44, 20:52])
