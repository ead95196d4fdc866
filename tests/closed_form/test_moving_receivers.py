# SPDX-License-Identifier: GPL-3.0-or-later
"""Small things that move beneath a shadow which stands: its edge stands too, however little of each it crosses."""

import numpy as np
import pytest
import snapshots as s
from test_refined_shading import CASTS_SHADOW, EDGE, LIT, VISIBLE, lit_right_of, moves, stage

TALL = 8


@pytest.mark.parametrize("edge", [13.6, 20.3, 27.8])
@pytest.mark.parametrize("size", [6, 9])
def test_the_edge_of_a_shadow_stands_on_tiles_that_move(size, edge):
    """Two rows of tiles, each shifted against the other, go 6 pixels; the edge crosses each somewhere else.  What was
    asked of a tile were two or three of its micropolygons, which the edge may pass by."""
    snapshot = stage(samples=256)
    for row in range(2):
        for k in range(-3, 12):
            x, y = k * size + 2.7 * row - 6, row * TALL
            s.quad(snapshot, s.rectangle(x, y, x + size, y + TALL, 20.0), 0, **moves(0.0, 6.0))
            snapshot["instances"]["flags"].append(VISIBLE)
    s.quad(snapshot, s.rectangle(-300, -300, edge, 300, 10.0), 0)
    snapshot["instances"]["flags"].append(CASTS_SHADOW)
    picture = s.render(snapshot)["combined"][..., 0] / LIT
    for row in range(2):
        seen = picture[row * TALL + 2 : (row + 1) * TALL - 2].mean(axis=0)
        # Of four rows the mean is right to a half of what it is of twelve.
        assert seen == pytest.approx(lit_right_of(edge), abs=2 * EDGE)
    assert np.ptp(picture) > 0.9
