# SPDX-License-Identifier: GPL-3.0-or-later
"""A lens that is wider than high, or higher: bounds of all that is seen through it, on every executor.

The raster executor draws REGULAR passes here.
"""

import numpy as np
import pytest
import snapshots as s
from test_hard_cases import options
from test_lens_motion import blurred_edge, hold

RATIOS = [0.25, 0.6, 3.0]


@pytest.fixture(params=["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
def executor(request):
    return request.param


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("knots", [1, 2])
def test_no_hole_between_grids_out_of_focus(executor, ratio, knots):
    """What the sides of a wide lens see was taken to be out of a grid's bounds: columns of dots, where buckets meet."""
    samples, passes = (4, 64) if executor == "RASTER" else (16, 1)
    snapshot = s.orthographic((96, 48), **options(executor, samples, passes, bucket_size=16))
    snapshot["camera"].update(lens_radius=3.0, focus_distance=2.0, lens_ratio=ratio)
    if knots > 1:
        snapshot["camera"]["lens_knots"] = np.array([(3.0, 2.0), (1.5, 2.5)])
    s.quad(snapshot, s.rectangle(-90, -90, 190, 190, 4.0), s.emission(snapshot))
    assert (s.alpha(snapshot) == 1.0).all()


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("edge", ["upright", "level"])
def test_edges_are_blurred_by_ellipses(executor, ratio, edge):
    """Half as high as wide: an upright edge is blurred twice as far as a level one, which the ratio leaves alone."""
    samples, passes = (16, 1024) if executor == "RASTER" else (64, 1)
    snapshot = s.orthographic((32, 32), **options(executor, samples, passes))
    snapshot["camera"].update(lens_radius=2.0, focus_distance=2.0, lens_ratio=ratio)
    corners = (-90, -90, 16, 90) if edge == "upright" else (-90, -90, 90, 16)
    s.quad(snapshot, s.rectangle(*corners, 4.0), s.emission(snapshot))
    picture = s.alpha(snapshot)
    radius = 2.0 / ratio if edge == "upright" else 2.0
    expected = blurred_edge(16, np.array([radius]), 32)
    hold(picture if edge == "upright" else picture.T, expected, max(samples, passes))
