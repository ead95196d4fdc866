# SPDX-License-Identifier: GPL-3.0-or-later
"""A lens that moves within the shutter, through whole frames: dicing, bounds, background, on every executor.

The raster executor draws REGULAR passes here.
"""

import numpy as np
import pytest
import snapshots as s
from test_hard_cases import options

MIDPOINTS = (np.arange(1024) + 0.5) / 1024


@pytest.fixture(params=["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
def executor(request):
    return request.param


def blurred_edge(edge, radii, pixels):
    """Share of pixels left of the edge, defocused by circles of these radii in turn."""
    fine = 8
    x = edge - (np.arange(pixels * fine) + 0.5) / fine
    d = np.clip(x[None] / np.maximum(radii, 1e-9)[:, None], -1, 1)
    share = 0.5 + (d * np.sqrt(1 - d**2) + np.arcsin(d)) / np.pi
    return share.mean(axis=0).reshape(pixels, fine).mean(axis=1)


def hold(picture, expected, n):
    """Four standard errors of independent samples, an upper bound, for the pixels and for the mean of columns."""
    deviation = 4 * np.sqrt(np.maximum(expected * (1 - expected), 1e-6) / n)
    assert (np.abs(picture - expected) <= deviation + 1 / n).all()
    assert (np.abs(picture.mean(axis=0) - expected) <= deviation / 2 + 1 / n).all()


def lens(snapshot, *knots):
    snapshot["camera"]["lens_knots"] = np.array(knots, float)


def test_rack_focus(executor):
    """The sharp plane goes from 25 to 100 through the edge at 50: circles of 6 |50 / F - 1| pixels."""
    samples, passes = (16, 1024) if executor == "RASTER" else (64, 1)
    snapshot = s.orthographic((32, 16), **options(executor, samples, passes))
    lens(snapshot, (6, 25), (6, 100))
    s.quad(snapshot, s.rectangle(-90, -90, 16, 90, 50), s.emission(snapshot))
    expected = blurred_edge(16, 6 * np.abs(50 / (25 + 75 * MIDPOINTS) - 1), 32)
    hold(s.alpha(snapshot), expected, max(samples, passes))


def test_opening_from_a_pinhole_before_a_moving_wall(executor):
    """Perspective: circles of f R |1 / F - 1 / z| pixels, z from 8 to 4 before a focus from 6 to 12."""
    samples, passes = (16, 1024) if executor == "RASTER" else (64, 1)
    snapshot = s.perspective((32, 16), 64.0, **options(executor, samples, passes))
    lens(snapshot, (0.0, 6.0), (0.8, 12.0))
    wall = [(-20, -20, 0), (0, -20, 0), (0, 20, 0), (-20, 20, 0)]
    ends = [s.translation(0, 0, 8), s.translation(0, 0, 4)]
    s.quad(snapshot, wall, s.emission(snapshot), transforms=ends)
    t = MIDPOINTS
    radii = 64 * 0.8 * t * np.abs(1 / (6 + 6 * t) - 1 / (8 - 4 * t))
    hold(s.alpha(snapshot), blurred_edge(16, radii, 32), max(samples, passes))


def test_a_small_thing_far_outside_is_not_lost(executor):
    """It lies 10 pixels outside of the frame and its circle reaches 20 only as the lens is widest."""
    samples, passes = (16, 1024) if executor == "RASTER" else (1024, 1)
    snapshot = s.orthographic((16, 16), **options(executor, samples, passes))
    lens(snapshot, (0, 10), (20, 10), (0, 10))
    s.quad(snapshot, s.rectangle(-12, 4, -8, 12, 20), s.emission(snapshot))
    t, fine = MIDPOINTS[::4], 8
    radii = 20 * (1 - np.abs(2 * t - 1))
    place = (np.arange(4) + 0.5, np.arange(8) + 0.5)
    dx = (np.arange(16 * fine) + 0.5) / fine + 12 - place[0][:, None]
    dy = (np.arange(16 * fine) + 0.5) / fine - 4 - place[1][:, None]
    squared = dx[:, None, None, :] ** 2 + dy[None, :, :, None] ** 2
    sums = np.zeros((16 * fine, 16 * fine))
    for r in radii:
        sums += (squared < r * r).sum(axis=(0, 1)) / (np.pi * r * r)
    expected = (sums / len(radii)).reshape(16, fine, 16, fine).mean(axis=(1, 3))
    picture = s.alpha(snapshot)
    assert expected.sum() > 0.5
    # All pixels together, with as many independent samples.
    n = 256 * max(samples, passes) / (256 if executor == "RASTER" else 1)
    p = expected.mean()
    assert abs(picture.mean() - p) <= 4 * np.sqrt(p * (1 - p) / n)


def busy(executor, knots=None, **more):
    """Busy things through a lens that moves, or through one with these knots."""
    lens_kind = "moving" if knots is None else True
    snapshot = s.busy(lens=lens_kind, **options(executor, 16, 4, **more))
    if knots:
        lens(snapshot, *knots)
    return s.render(snapshot)["combined"]


def test_a_still_lens_said_by_knots(executor):
    still = busy(executor, ())
    assert np.array_equal(still, busy(executor, [(0.02, 4)]))
    assert np.array_equal(still, busy(executor, [(0.02, 4)] * 3))
    assert not np.array_equal(still, busy(executor, [(0.02, 4), (0.02, 5)]))


@pytest.mark.parametrize(
    "change",
    [{"bucket_size": 16}, {"bucket_size": 128}, {"threads": 1}, {"threads": 3}],
    ids=str,
)
def test_buckets_and_threads_change_no_bit(executor, change):
    base = busy(executor)
    assert np.ptp(base[..., 3]) > 0.5 and np.array_equal(base, busy(executor, **change))


@pytest.mark.parametrize("crop", [(0, 0, 96, 1), (13, 17, 64, 41)])
def test_crop_changes_no_bit(executor, crop):
    whole, part = busy(executor), busy(executor, crop=np.array(crop, np.int32))
    assert np.array_equal(whole[crop[1] : crop[3], crop[0] : crop[2]], part)


def test_the_world_is_defocused_like_a_wall_that_is_far_away(executor):
    """It is 1 right of the axis, as is a wall so far away that it moves by f R / z = 2e-4 pixels."""
    samples, passes = (16, 64) if executor == "RASTER" else (64, 1)

    def picture(world):
        snapshot = s.perspective(
            (48, 16), 64.0, clip=(0.1, 1e6), **options(executor, samples, passes)
        )
        lens(snapshot, (0.1, 1.0), (0.4, 4.0), (0.3, 2.0))
        if world:
            s.half_world(snapshot)
        else:
            far = 1e5
            s.quad(snapshot, s.rectangle(0, -far, far, far, far), s.emission(snapshot))
        return s.render(snapshot)["combined"][..., 0]

    # REGULAR asks the world at the corners of pixels: a step becomes a ramp of a pixel.
    assert np.ptp(picture(True)) > 0.9
    bound = 1.5 / np.sqrt(samples) if executor == "RASTER" else 2 / samples
    assert np.abs(picture(True) - picture(False)).max() <= bound


@pytest.mark.parametrize(
    "knots, message",
    [
        (np.zeros((0, 2)), "at least one knot"),
        (np.array([[0.1, 0.0]]), "above 0"),
        (np.array([[-0.1, 1.0]]), "at least 0"),
        (np.array([[0.1, np.nan]]), "above 0"),
        (np.array([[0.1, np.inf]]), "above 0"),
    ],
)
def test_bad_knots_are_refused(knots, message):
    import granita_core

    snapshot = s.orthographic((8, 8))
    snapshot["camera"]["lens_knots"] = knots
    with pytest.raises(granita_core.SceneError, match=message):
        s.render(snapshot)
