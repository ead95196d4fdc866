# SPDX-License-Identifier: GPL-3.0-or-later
"""Moving geometry against closed forms (docs/hard_cases.md).

Predicted sampling error: the "Owen" column of docs/sampling_error.md for edges moving L pixels at N samples, one pixel
box; between its rows the next worse one.  A single pixel may be off by 4 times that, the RMSE by 1.3 times.
"""

import numpy as np
import pytest
import snapshots as s
from moving_edge import add_moving_edge

OWEN = {(5, 64): 0.0135, (20, 64): 0.0092, (20, 256): 0.0035, (100, 64): 0.0069, (100, 256): 0.0023}


@pytest.mark.parametrize("speed, samples", sorted(OWEN))
def test_edge_moving_right(executor, speed, samples):
    """Case 10."""
    width = speed + 30
    snapshot = s.orthographic((width, 16), samples=samples, executor=executor)
    expected = np.broadcast_to(add_moving_edge(snapshot, width, speed), (16, width))
    error = s.alpha(snapshot) - expected
    blurred = (expected > 0) & (expected < 1)
    assert np.sqrt(np.mean(error[blurred] ** 2)) <= 1.3 * OWEN[speed, samples]
    assert np.abs(error).max() <= 4 * OWEN[speed, samples]
    # 16 rows x L blurred pixels of independent error: a bias of 4 standard errors would be seen.
    assert abs(error[blurred].mean()) <= 4 * OWEN[speed, samples] / np.sqrt(blurred.sum())


def test_moving_disc_time_fraction(executor):
    """Case 13: fraction of the shutter during which a moving disc covers a point, R = 10, L = 40."""
    radius, length, n = 10.0, 40.0, 256
    snapshot = s.orthographic((80, 32), samples=n, executor=executor)
    points, faces = s.disc(radius, (20.5, 16.5))
    s.mesh(
        snapshot,
        points,
        faces,
        s.emission(snapshot),
        transforms=[s.translation(0), s.translation(length)],
    )
    x, y = np.meshgrid(np.arange(80) - 20.0, np.arange(32) - 16.0)
    # The pixel's mean of the point formula, by a 16 x 16 midpoint rule.
    expected = np.zeros_like(x)
    offsets = (np.arange(16) + 0.5) / 16 - 0.5
    for ox in offsets:
        for oy in offsets:
            h = np.sqrt(np.maximum(radius**2 - (y + oy) ** 2, 0))
            lo, hi = np.clip(x + ox - h, 0, length), np.clip(x + ox + h, 0, length)
            expected += (hi - lo) / length / 256
    error = s.alpha(snapshot) - expected
    assert np.abs(error).max() <= 4 * 2 * OWEN[20, 256]  # two edges pass each pixel
    assert abs(error.sum()) <= 1e-3 * expected.sum()


def disc_at(z0, z1, clip, executor, samples=1024):
    """Alpha of the ring at radius 120 px around the axis of a unit disc that moves from z0 to z1; focal 500 px."""
    size = (16, 4)
    # Coarse dicing keeps the brute force short; the disc is flat, so it changes nothing.
    snapshot = s.perspective(
        size,
        500.0,
        center=(-120.0 + 8, 2.0),
        clip=clip,
        samples=samples,
        executor=executor,
        dicing_rate=8,
    )
    points, faces = s.disc(1.0, z=0.0)
    transforms = [s.translation(0, 0, z0), s.translation(0, 0, z1)]
    s.mesh(snapshot, points, faces, s.emission(snapshot), transforms=transforms)
    return s.alpha(snapshot)


def test_dolly_is_linear_before_projection(executor):
    """Case 16: coverage at radius r is 1 - t*, t* = (X f / r - z0) / (z1 - z0); .27083 at r = 120."""
    image = disc_at(10.0, 2.0, (0.1, 100.0), executor)
    r = 120 + (np.arange(16) + 0.5 - 8)
    y = np.arange(4) + 0.5 - 2
    r = np.hypot(r[None, :], y[:, None])
    expected = 1 - (500.0 / r - 10.0) / (2.0 - 10.0)
    assert abs(expected[:, 7:9].mean() - 0.27083) < 1e-3
    # One edge over about 60 px at 1024 samples: the L = 100, N = 256 row, halved by sqrt(1024 / 256).
    assert np.abs(image - expected).max() <= 4 * OWEN[100, 256] / 2


def test_through_the_near_plane(executor):
    """Case 17: z = 2 - 3 t, near .1: (min(2, X f / r) - .1) / 3 = .6333."""
    image = disc_at(2.0, -1.0, (0.1, 100.0), executor)
    # Time alone decides: N = 1024 stratified times err by at most 1/N at each of two ends.
    assert np.abs(image - (2.0 - 0.1) / 3.0).max() <= 4 * 2 / 1024


def test_scale_through_zero(executor):
    """Case 18: scale 1 - 2 t of a disc of radius 50: coverage at radius r = 1 - r / R."""
    # Coarse dicing keeps the brute force short; the disc is flat, so it changes nothing.
    snapshot = s.orthographic((56, 8), samples=256, executor=executor, dicing_rate=8)
    points, faces = s.disc(50.0, z=0.0)
    scales = [np.diag([k, k, k, 1.0]) for k in (1.0, 0.0, -1.0)]
    moved = [s.translation(0.0, 0.0, 5.0) @ m for m in scales]
    s.mesh(snapshot, points, faces, s.emission(snapshot), transforms=moved)
    r = np.hypot(*np.meshgrid(np.arange(56) + 0.5, np.arange(8) + 0.5))
    expected = np.maximum(1 - r / 50, 0)
    error = s.alpha(snapshot) - expected
    away = (np.abs(r - 50) > 2) & (r > 2)
    assert (
        np.abs(error[away]).max() <= 4 * 2 * OWEN[100, 256]
    )  # the outline passes inwards and outwards


@pytest.mark.parametrize("knots", [2, 3, 5])
def test_straight_mover_does_not_depend_on_knots(executor, knots):
    """Equidistant knots on a straight path are the same motion; rounding of the knots is all that differs."""
    images = []
    for k in (2, knots):
        snapshot = s.orthographic((48, 16), samples=64, executor=executor)
        transforms = [s.translation(16.0 * i / (k - 1)) for i in range(k)]
        s.quad(snapshot, s.rectangle(4, 2, 16, 14), s.emission(snapshot), transforms=transforms)
        images.append(s.alpha(snapshot))
    assert np.abs(images[0] - images[1]).max() <= 1 / 64
    assert np.mean(images[0] != images[1]) < 0.01


def test_out_and_back(executor):
    """Case 21: a square that visits the pixel only in mid-shutter is not lost; coverage = time fraction."""
    snapshot = s.orthographic((64, 16), samples=256, executor=executor)
    transforms = [s.translation(x) for x in (-100.0, 30.0, -100.0)]
    s.quad(snapshot, s.rectangle(0, 0, 10, 16), s.emission(snapshot), transforms=transforms)
    image = s.alpha(snapshot)
    # Speed 260 px over the shutter. Pixel p is covered while x(t) in (p - 9.5, p + .5), the reach is 30: at p = 35
    # from x = 25.5 to 30 and back.
    expected = 2 * 4.5 / 260
    assert np.abs(image[:, 35].mean() - expected) <= 4 * OWEN[100, 256] / 4  # mean of 16 pixels


def test_very_fast_tiny_square(executor):
    """Case 26: 5000 px in the shutter, off both sides: I0 over what is on screen = area x share of the time."""
    snapshot = s.orthographic((128, 16), samples=1024, executor=executor)
    transforms = [s.translation(-2500), s.translation(2500)]
    s.quad(snapshot, s.rectangle(60, 6, 64, 10), s.emission(snapshot), transforms=transforms)
    # Sum over pixels: 16 px^2 for the time in which it is on screen, 128 of 5000 px.
    expected = 16 * 128 / 5000
    # 512 pixels of its row band, each N binary samples of probability 4 / 5000.
    standard_error = np.sqrt(512 * (4 / 5000) / 1024)
    assert abs(s.alpha(snapshot).sum() - expected) <= 4 * standard_error


def test_the_world_passes_a_camera_that_turns(executor):
    """Its axes go straight from knot to knot, as matrices do: the plane x = 0 is seen at
    -t sin(a) / (1 - t + t cos(a)) focal lengths from the middle."""
    focal, angle, samples = 64.0, 0.32, 64
    snapshot = s.perspective((48, 16), focal, samples=samples, executor=executor)
    s.half_world(snapshot)
    turned = np.eye(4)
    turned[0, 0] = turned[2, 2] = np.cos(angle)
    turned[0, 2], turned[2, 0] = np.sin(angle), -np.sin(angle)
    snapshot["camera"]["world_from_camera"] = np.stack([np.eye(4), turned])
    t = (np.arange(4000) + 0.5) / 4000
    edge = 24 - focal * t * np.sin(angle) / (1 - t + t * np.cos(angle))
    lit = np.clip(np.arange(48)[:, None] + 1 - edge, 0, 1).mean(axis=1)
    picture = s.render(snapshot)["combined"][..., 0]
    # It moves 21 pixels.
    assert np.abs(picture - lit).max() <= 4 * OWEN[20, samples]
