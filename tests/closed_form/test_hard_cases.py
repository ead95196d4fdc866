# SPDX-License-Identifier: GPL-3.0-or-later
"""Hard cases of visibility that no other file has, on every executor (docs/hard_cases.md).

The raster executor draws REGULAR passes: its tolerances are those of a lattice and a midpoint rule in time.
"""

import numpy as np
import pytest
import snapshots as s
from moving_edge import ramp
from test_elements import cloud, curves

# RMSE of a (0,2)-net of 64 samples for an edge that moves 20 pixels (docs/sampling_error.md).
OWEN_20_64 = 0.0092
# Two such edges pass a pixel.
TWO_EDGES = np.sqrt(2) * OWEN_20_64


@pytest.fixture(params=["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
def executor(request):
    return request.param


def options(executor, samples=64, passes=1, **more):
    """RASTER: `passes` of a lattice of `samples`; the others: as many INDEPENDENT samples."""
    if executor == "RASTER":
        more |= {"sampling": "REGULAR", "time_samples": passes}
    return {"executor": executor, "samples": samples, **more}


def mitchell_response(d):
    """E(d) by the midpoint rule, from the filter's formula (Mitchell and Netravali 1988, B = C = 1/3)."""
    x = (np.arange(8000) + 0.5) / 2000 - 2
    a = np.abs(x)
    near = (7 * a**3 - 12 * a**2 + 16 / 3) / 6
    far = (-7 / 3 * a**3 + 12 * a**2 - 20 * a + 32 / 3) / 6
    sums = np.concatenate([[0], np.cumsum(np.where(a < 1, near, far)) / 2000])
    return np.interp(d, np.linspace(-2, 2, 8001), sums)


def test_a_filter_spills_over_an_empty_bucket(executor):
    """Case 6: the edge lies .3 px right of the border of buckets of 16."""

    def picture(bucket):
        more = {"pixel_filter": "MITCHELL", "filter_width": 4.0, "bucket_size": bucket}
        snapshot = s.orthographic((32, 8), **options(executor, 256, **more))
        s.quad(snapshot, s.rectangle(16.3, -9, 60, 30), s.emission(snapshot))
        return s.alpha(snapshot)

    pictures = [picture(bucket) for bucket in (16, 32, 64)]
    expected = 1 - mitchell_response(16.3 - (np.arange(32) + 0.5))
    # 16 strata a pixel along x: half a stratum of the filter's largest value, .89.
    assert np.abs(pictures[0] - expected).max() <= 0.89 / 32
    assert np.array_equal(pictures[0], pictures[1]) and np.array_equal(pictures[0], pictures[2])


@pytest.mark.parametrize("sampling", ["INDEPENDENT", "REGULAR"])
@pytest.mark.parametrize("pixel_filter", ["BOX", "BLACKMAN_HARRIS", "LANCZOS"])
def test_a_filter_without_a_sample_shows_the_nearest(executor, sampling, pixel_filter):
    """Few pixels have a sample within a hundredth of their centre."""
    more = {"pixel_filter": pixel_filter, "filter_width": 0.01, "sampling": sampling}
    snapshot = s.orthographic((24, 8), executor=executor, samples=4, **more)
    s.quad(snapshot, s.rectangle(-9, -9, 12.4, 30), s.emission(snapshot))
    if executor != "RASTER":
        snapshot["options"]["passes"] = ["Emission"]
    made = s.render(snapshot)
    pictures = [made["combined"][..., 3]]
    if executor != "RASTER":
        pictures.append(made["passes"]["Emission"][..., 0])
    for picture in pictures:
        assert np.abs(picture[:, :12] - 1).max() <= 1e-6
        assert np.abs(picture[:, 13:]).max() == 0


def test_a_holdout_that_is_clear_in_part_cuts_as_much_as_it_covers(executor):
    """Of .4, over a wall in the left half and nothing in the right one."""
    for film_transparent, right in ((True, 0.0), (False, 0.6)):
        snapshot = s.orthographic(
            (16, 8), executor=executor, samples=4, film_transparent=film_transparent
        )
        s.quad(snapshot, s.rectangle(-9, -9, 40, 40, 2.0), s.emission(snapshot, alpha=0.4))
        s.quad(snapshot, s.rectangle(-9, -9, 8, 40, 4.0), s.emission(snapshot))
        snapshot["instances"]["flags"] = [7, 3]
        picture = s.render(snapshot)["combined"]
        assert np.abs(picture[:, :8] - 0.6).max() < 1e-6
        assert np.abs(picture[:, 8:, 3] - right).max() < 1e-6
        assert np.abs(picture[:, 8:, :3]).max() == 0


EDGE = 12.3125  # between two columns of a lattice of 16


def strobed(sampling, executor):
    """An edge that takes 10 steps of 2 px: how much of the pattern of 10 copies is in the picture, 1 all, 0 none."""
    more = {"pixel_filter": "MITCHELL", "filter_width": 4.0, "dicing_rate": 20}
    more |= {"sampling": sampling, "time_samples": 10, "samples": 256, "executor": executor}
    snapshot = s.orthographic((48, 8), **more)
    move = [s.translation(0), s.translation(20)]
    s.quad(snapshot, s.rectangle(-90, -20, EDGE, 30), s.emission(snapshot), transforms=move)
    x = np.arange(48) + 0.5
    copies = np.mean([mitchell_response(EDGE + 2 * (j + 0.5) - x) for j in range(10)], axis=0)
    steps = (np.arange(2000) + 0.5) / 100
    smooth = np.mean([mitchell_response(EDGE + step - x) for step in steps], axis=0)
    pattern = (copies - smooth) - (copies - smooth).mean()
    return ((s.alpha(snapshot) - smooth) @ pattern / (pattern @ pattern)).mean()


def test_passes_strobe_and_samples_do_not(executor):
    """Case 11: Mitchell ripples by .78 at steps of 2 px (docs/sampling_error.md)."""
    assert abs(strobed("REGULAR", executor) - 1) <= 0.03
    if executor != "RASTER":
        # The pattern's norm is .04; 8 rows of 48 pixels with errors of .0023: a share of .02 by chance.
        assert abs(strobed("INDEPENDENT", executor)) <= 4 * 0.02


def test_passes_of_their_own_number_do_not_ripple(executor):
    """Case 11: a line of a pixel that moves 40 pixels, Cycles' default filter: 2 % is what passes are chosen for."""
    more = {"pixel_filter": "BLACKMAN_HARRIS", "filter_width": 1.5, "sampling": "REGULAR"}
    snapshot = s.orthographic((64, 4), executor=executor, samples=64, **more)
    move = [s.translation(0), s.translation(40)]
    s.quad(snapshot, s.rectangle(10.3, -20, 11.3, 90), s.emission(snapshot), transforms=move)
    row = s.alpha(snapshot).mean(0)[16:46]  # 12 periods of pixels and copies, away from both ends
    assert np.ptp(row / row.mean()) / 2 <= 0.02


def test_a_patch_that_moves_by_its_own_width(executor):
    """Case 12: the overlap's triangle."""
    snapshot = s.orthographic((64, 8), **options(executor, 64, 64, dicing_rate=20))
    move = [s.translation(0), s.translation(20)]
    s.quad(snapshot, s.rectangle(10, -9, 30, 30), s.emission(snapshot), transforms=move)
    x = np.arange(64)
    expected = (ramp(30 - x + 20) - ramp(30 - x) - ramp(10 - x + 20) + ramp(10 - x)) / 20
    error = np.abs(s.alpha(snapshot) - expected)
    assert error.max() <= 4 * TWO_EDGES


def grating(executor, sampling):
    """Period 4, half covered, moving by 8 pixels; the instants of two passes are a period apart."""
    more = {"executor": executor, "sampling": sampling, "samples": 64, "time_samples": 2}
    snapshot = s.orthographic((32, 8), dicing_rate=20, **more)
    points = [p for k in range(-4, 9) for p in s.rectangle(4 * k, -9, 4 * k + 2, 30)]
    faces = [tuple(range(4 * k, 4 * k + 4)) for k in range(13)]
    move = [s.translation(-6), s.translation(2)]
    s.mesh(snapshot, points, faces, s.emission(snapshot), transforms=move)
    return s.alpha(snapshot)


def test_a_grating_that_moves_by_periods(executor):
    """Case 14: half covered everywhere; passes a period apart, the worst of all, do not blur it at all."""
    bars = np.broadcast_to(np.arange(32) % 4 < 2, (8, 32))
    assert np.array_equal(grating(executor, "REGULAR"), bars)
    if (
        executor != "RASTER"
    ):  # long ways cost llvmpipe minutes; test_raster_samples.py has short ones
        alpha = grating(executor, "INDEPENDENT")
        assert np.sqrt(np.mean((alpha - 0.5) ** 2)) <= 0.5 / 8  # of 64 random samples
        assert abs(alpha.mean() - 0.5) <= 4 * 0.5 / np.sqrt(64 * 256)


def test_what_moves_with_its_occluder_is_the_still_picture_blurred(executor):
    """Case 23: of an object from 10 to 30 the occluder leaves 18 to 30; both move by 20."""
    snapshot = s.orthographic((64, 8), **options(executor, 64, 64, dicing_rate=20))
    move = [s.translation(0), s.translation(20)]
    black, red = s.emission(snapshot, (0, 0, 0)), s.emission(snapshot, (1, 0, 0))
    s.quad(snapshot, s.rectangle(2, -9, 18, 30, 1.0), black, transforms=move)
    s.quad(snapshot, s.rectangle(10, -9, 30, 30, 2.0), red, transforms=move)
    x = np.arange(64)
    expected = (ramp(30 - x + 20) - ramp(30 - x) - ramp(18 - x + 20) + ramp(18 - x)) / 20
    error = np.abs(s.render(snapshot)["combined"][..., 0] - expected)
    assert error.max() <= 4 * TWO_EDGES


def test_a_sharp_edge_before_a_defocused_one(executor):
    """Case 31: nothing of the background bleeds over what is in focus, nothing of the front behind it."""
    radius, samples, passes = 6.0, 64, 1024
    lens = options(executor, 16 if executor == "RASTER" else samples, passes, dicing_rate=40)
    snapshot = s.orthographic((48, 24), **lens)
    snapshot["camera"].update(lens_radius=radius, focus_distance=2.0)
    s.quad(snapshot, s.rectangle(-30, -40, 16, 60, 2.0), s.emission(snapshot, (0, 1, 0)))
    s.quad(snapshot, s.rectangle(-90, -90, 90, 12, 4.0), s.emission(snapshot, (1, 0, 0)))
    picture = s.render(snapshot)["combined"]
    assert np.array_equal(picture[:, :16], np.broadcast_to((0, 1, 0, 1), (24, 16, 4)))
    fine = (
        12 - (np.arange(24 * 32) + 0.5) / 32
    )  # the disc's share below the edge, at 32 places a pixel
    d = np.clip(fine / radius, -1, 1)
    share = 0.5 + (d * np.sqrt(1 - d**2) + np.arcsin(d)) / np.pi
    expected = share.reshape(24, 32).mean(axis=1)[:, None]
    n = passes if executor == "RASTER" else samples
    # Four standard errors of independent samples, an upper bound of both kinds' error.
    bound = 4 * np.sqrt(np.maximum(expected * (1 - expected), 1e-6) / n) + 1 / n
    assert (np.abs(picture[:, 16:, 0] - expected) <= bound).all()
    assert not picture[:, 16:, 1].any()


def test_outline_of_a_sphere_off_the_axis(executor):
    """Case 56: a plane cuts the tangent cone of half angle a, tilted by b, in an ellipse of the semi-axes
    sin a cos a / (cos^2 b - sin^2 a) and sin a / sqrt(cos^2 b - sin^2 a); no hole at the poles."""
    focal, radius, place = 60.0, 1.0, np.array([1.2, 0.4, 3.0])
    snapshot = s.perspective((96, 80), focal, center=(30.0, 30.0), **options(executor))
    cloud(snapshot, [place], radius, s.emission(snapshot))
    distance = np.linalg.norm(place)
    sin2, cos2 = (radius / distance) ** 2, (place[2] / distance) ** 2
    axes = np.sqrt(sin2 * (1 - sin2)) / (cos2 - sin2), np.sqrt(sin2 / (cos2 - sin2))
    area = np.pi * axes[0] * axes[1] * focal**2
    alpha = s.alpha(snapshot)
    # Some 150 pixels on the outline, each with a 64-sample error of .044 (64^-.75).
    assert abs(alpha.sum() - area) <= 4 * 0.044 * np.sqrt(150)
    inside = alpha[30:44, 44:64]
    assert (inside == 1).all()


def test_a_thousand_grids_of_one_micropolygon_are_one_large_one(executor):
    """Case 59 and M5, bit by bit; slanted in depth, so that only coverage can be alike."""
    pictures = []
    for pieces in (1, 32):
        snapshot = s.orthographic((40, 40), **options(executor, 16))
        material = s.emission(snapshot, (1, 1, 1), 0.5)
        points, faces = [], []
        edges = 2.3 + 32.0 * np.arange(pieces + 1) / pieces
        for y0, y1 in zip(edges, edges[1:]):
            for x0, x1 in zip(edges, edges[1:]):
                faces.append(tuple(range(len(points), len(points) + 4)))
                points += [(x, y, 1 + x / 64) for x, y, _ in s.rectangle(x0, y0, x1, y1)]
        s.mesh(snapshot, points, faces, material)
        pictures.append(s.render(snapshot)["combined"])
    assert np.array_equal(*pictures)
    assert (pictures[0][4:33, 4:33, 3] == 0.5).all()


@pytest.mark.parametrize("executor", ["SIMD", "RASTER"])
def test_grids_of_one_micropolygon_by_the_ten_thousands(executor):
    """Case 59 at its own size: 65,536 grids, each of one micropolygon of an eighth of a pixel, are one large one."""
    pieces = 256
    pictures = []
    for side in (1, pieces):
        snapshot = s.orthographic(
            (40, 40), **options(executor, 16), grid_size=1 if side > 1 else 256
        )
        edges = (2.25 + 32.0 * np.arange(side + 1) / side).astype(np.float32)
        x0, y0 = (v.ravel() for v in np.meshgrid(edges[:-1], edges[:-1]))
        x1, y1 = (v.ravel() for v in np.meshgrid(edges[1:], edges[1:]))
        corners = np.stack([np.stack(c, -1) for c in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))], 1)
        points = np.concatenate([corners, 1 + corners[..., :1] / 64], -1).reshape(-1, 3)
        faces = np.arange(len(points)).reshape(-1, 4)
        s.mesh(snapshot, points, faces, s.emission(snapshot, (1, 1, 1), 0.5))
        result = s.render(snapshot)
        if side > 1:
            assert result["statistics"]["grids_diced"] >= pieces**2
        pictures.append(result["combined"])
    assert np.array_equal(*pictures)
    assert (pictures[0][4:33, 4:33, 3] == 0.5).all()


def test_hair_and_points_of_no_width_are_not_there(executor):
    """Case 57, at rest and in motion."""
    snapshot = s.orthographic((64, 32), **options(executor, 16, 4))
    material = s.emission(snapshot)
    hair = np.array([(10.5, 16.5, 1), (30, 20, 1), (50.5, 16.5, 1)])
    for knots in (hair, [hair, hair + (5, 3, 0)]):
        curves(snapshot, knots, [3], 0.0, material)
        cloud(snapshot, knots, 0.0, material)
    assert not s.alpha(snapshot).any()


def test_hair_that_narrows_to_nothing_is_a_triangle(executor):
    """Case 57: 40 px long, 8 px wide at its root."""
    snapshot = s.orthographic((64, 32), **options(executor))
    curves(snapshot, [(10.5, 16.5, 1), (50.5, 16.5, 1)], [2], [4, 0], s.emission(snapshot))
    # Two outlines of 40 pixels, each pixel with a 64-sample error of .044 (64^-.75).
    assert abs(s.alpha(snapshot).sum() - 160) <= 4 * 0.044 * np.sqrt(80)


def test_a_cusp_covers_what_the_way_there_covers(executor):
    """Case 57: out and back by the same way; at the turn the curve has no direction, and its ribbon does not
    stick out."""
    snapshot = s.orthographic((64, 32), **options(executor))
    curves(snapshot, [(10, 16, 1), (50, 16, 1), (10, 16, 1)], [3], 8.0, s.emission(snapshot))
    expected = np.zeros((32, 64))
    expected[8:24, 10:50] = 1
    assert np.array_equal(s.alpha(snapshot), expected)


def test_hair_that_stands_at_its_root_does_not_stick_out(executor):
    """Case 57: its first points are one.  The curve swings past it by 4/27 of its speed there, 10 px, and back."""
    snapshot = s.orthographic((64, 32), **options(executor))
    root = [(10, 16, 1)] * 5
    curves(snapshot, [*root, (30, 16, 1), (50, 16, 1)], [7], 8.0, s.emission(snapshot))
    alpha = s.alpha(snapshot)
    assert (alpha[8:24, 10:50] == 1).all()
    alpha[8:24, 8:50] = 0
    assert not alpha.any()


def test_the_camera_inside_of_hair(executor):
    """Case 57: the axis runs parallel to the view, a metre to the right and 10 metres far; the ribbon, 3 metres
    to both sides, is the plane x = 1, of which the pixel (u, v) sees the depth f / u."""
    focal = 20.0
    snapshot = s.perspective((64, 48), focal, **options(executor))
    curves(snapshot, [(1, 0, -10), (1, 0, 0), (1, 0, 10)], [3], 3.0, s.emission(snapshot))
    fine = 16
    u = (np.arange(64 * fine) + 0.5) / fine - 32
    v = (np.arange(48 * fine) + 0.5) / fine - 24
    seen = (u[None] > focal / 10) & (np.abs(v[:, None]) < 3 * u[None])
    expected = seen.reshape(48, fine, 64, fine).mean(axis=(1, 3))
    alpha = s.alpha(snapshot)
    # Of its three sides: a pixel is inside of all with all its corners, or outside of one.
    u, v = np.meshgrid(np.arange(65) - 32, np.arange(49) - 24)
    sides = np.stack([u - focal / 10, 3 * u - v, 3 * u + v])
    corners = np.stack([sides[:, i : i + 48, j : j + 64] for i in (0, 1) for j in (0, 1)])
    assert (alpha[(corners >= 0).all(axis=(0, 1))] == 1).all()
    assert (alpha[(corners <= 0).all(axis=0).any(axis=0)] == 0).all()
    # A slanted edge's 64-sample error (64^-.75), four times.
    assert np.abs(alpha - expected).max() <= 4 * 0.044
