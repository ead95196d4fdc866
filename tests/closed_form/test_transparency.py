# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of transparency against closed forms (hider-research, section 4.4)."""

import numpy as np
import pytest
import snapshots as s


def stack(executor, layers, **options):
    """layers: (z, alpha, colour); each covers the frame."""
    snapshot = s.orthographic((16, 16), samples=16, executor=executor, **options)
    for z, a, color in layers:
        s.quad(snapshot, s.rectangle(-40, -40, 60, 60, z), s.emission(snapshot, color, a))
    return s.render(snapshot)["combined"]


@pytest.mark.parametrize(
    "count, a, expected", [(128, 1 / 128, 0.6335623), (1000, 0.001, 0.6323046)]
)
def test_many_equal_layers(executor, count, a, expected):
    """Case 35: 1 - (1 - a)^n, to float rounding: 1000 additions of 2^-24 relative error."""
    image = stack(executor, [(1 + 0.01 * i, a, (1, 1, 1)) for i in range(count)])
    assert np.abs(image[..., 3] - expected).max() <= 1000 * 2.0**-24


def test_colours_front_to_back(executor):
    """Case 35: colour of layer i is a (1 - a)^i c_i, whatever the order in which layers are given."""
    image = stack(executor, [(3, 0.5, (0, 0, 1)), (1, 0.5, (1, 0, 0)), (2, 0.5, (0, 1, 0))])
    assert np.abs(image - [0.5, 0.25, 0.125, 0.875]).max() <= 1e-6


def test_coincident_layers_both_count(executor):
    """Case 40."""
    image = stack(executor, [(1, 0.3, (1, 1, 1)), (1, 0.6, (1, 1, 1))])
    assert np.abs(image[..., 3] - (1 - 0.7 * 0.4)).max() <= 1e-6


def test_opacity_threshold_is_exact(executor):
    """Case 38: planes of .1 under the threshold .2 stop after the third layer (.271)."""
    for bucket in (16, 64):
        layers = [(1 + i, 0.1, (1, 1, 1)) for i in range(20)]
        image = stack(executor, layers, opacity_threshold=0.2, bucket_size=bucket)
        assert np.abs(image[..., 3] - 0.271).max() <= 1e-6


def test_opaque_hides_what_is_behind(executor):
    """Case 44 and M6: geometry behind an opaque plane changes no bit."""
    front = [(1, 0.25, (1, 0, 0)), (2, None, (0, 1, 0))]
    behind = [(3, 0.5, (0, 0, 1)), (4, None, (1, 1, 1))]
    assert np.array_equal(stack(executor, front), stack(executor, front + behind))


def test_time_correlated_layers(executor):
    """Case 41: covers [.2, .6] with .5 and [.1, .6] with .7: T = .59, not the .52 of blur-then-composite."""
    # Coarse dicing keeps the brute force short; the bands are flat.
    snapshot = s.orthographic((16, 16), samples=1024, executor=executor, dicing_rate=32)
    length = 1000.0

    def covering(t0, t1, z, a):
        """A band moving right so that it covers the frame's centre pixel during [t0, t1]."""
        s.quad(
            snapshot,
            s.rectangle(8 - length * t1, -20, 8 - length * t0, 40, z),
            s.emission(snapshot, (1, 1, 1), a),
            transforms=[s.translation(0), s.translation(length)],
        )

    covering(0.2, 0.6, 1.0, 0.5)
    covering(0.1, 0.6, 2.0, 0.7)
    image = s.alpha(snapshot)
    # Each pixel's times are stratified: four crossings err by at most 1/N each, and a pixel's place shifts them by 8/1000.
    assert np.abs(image[:, 7:9].mean() - 0.41) <= 4 / 1024 + 1 / length


def test_diced_patch_has_no_seams(executor):
    """Case 42: the interior of a diced transparent patch is constant."""
    snapshot = s.perspective((64, 64), 60.0, samples=16, executor=executor, grid_size=64)
    points = [(-2, -2, 2), (2, -2, 4), (2, 2, 5), (-2, 2, 2.5)]
    s.quad(snapshot, points, s.emission(snapshot, (1, 1, 1), 0.37))
    image = s.alpha(snapshot)[24:40, 24:40]
    assert np.abs(image - 0.37).max() <= 1e-6


def test_moving_transparent_patch_has_no_seams(executor):
    """Case 42 in motion: shared edges are hit once at any time."""
    snapshot = s.orthographic((64, 64), samples=64, executor=executor, grid_size=16)
    transforms = [s.translation(-6.3, 2.1), s.translation(6.9, -3.7)]
    s.quad(
        snapshot,
        s.rectangle(-60, -60, 120, 120),
        s.emission(snapshot, (1, 1, 1), 0.37),
        transforms=transforms,
    )
    assert np.abs(s.alpha(snapshot) - 0.37).max() <= 1e-6
