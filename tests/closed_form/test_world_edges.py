# SPDX-License-Identifier: GPL-3.0-or-later
"""What a world draws has edges finer than pixels, before a camera that stands still too."""

import numpy as np
import pytest
import snapshots as s

SIZE = (48, 16)
# Sixteen by sixteen samples of a pixel are a net: an upright edge is right to one column of it.
EDGE = 1 / 16


def picture(center, executor="SIMD", **options):
    """Of a world that is 1 right of the column `center`, 0 left of it, by a slope: which is no pattern."""
    options = {"samples": 256, **options}
    snapshot = s.perspective(SIZE, 40.0, center=(center, 8.0), executor=executor, **options)
    s.half_world(snapshot)
    edge = next(n for n in snapshot["world"]["nodes"] if n["type"] == "ShaderNodeMath")
    edge["properties"] = {"operation": "MULTIPLY", "use_clamp": True}
    edge["inputs"]["Value_001"] = 1e7
    return s.render(snapshot)["combined"][..., 0]


@pytest.mark.parametrize("executor", ["SIMD", "COMPUTE", "REFERENCE"])
@pytest.mark.parametrize("edge", [20.3, 20.5, 20.9])
def test_an_edge_is_where_it_is(executor, edge):
    row = picture(edge, executor).mean(axis=0)
    assert row == pytest.approx(np.clip(np.arange(SIZE[0]) + 1 - edge, 0, 1), abs=EDGE)


def test_an_edge_moves_smoothly():
    """A column's light rises with the edge, rather than in steps of the pixel's."""
    levels = [picture(20 + i / 16)[:, 20].mean() for i in range(17)]
    assert np.abs(np.array(levels) - np.linspace(1, 0, 17)).max() < EDGE


def test_no_threshold_no_edge():
    """That the tests above can fail."""
    row = picture(20.3, shading_threshold=1000.0).mean(axis=0)
    assert abs(row[20] - 0.7) > EDGE or abs(row[21] - 1.0) > EDGE


@pytest.mark.parametrize("change", [{"bucket_size": 16}, {"threads": 1}], ids=str)
def test_buckets_and_threads_change_no_bit(change):
    assert np.array_equal(picture(20.3), picture(20.3, **change))
