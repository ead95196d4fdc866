# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture is a function of the scene and the sample table: metamorphic identities, bit for bit."""

import numpy as np
import pytest
import snapshots as s

WIDTHS = {"BOX": 1.0, "MITCHELL": 4.0}


@pytest.mark.parametrize(
    "change", [{"bucket_size": 16}, {"bucket_size": 128}, {"threads": 1}, {"threads": 3}], ids=str
)
def test_buckets_and_threads_change_no_bit(executor, change):
    base = s.render(s.busy(executor))["combined"]
    assert np.ptp(base[..., 3]) > 0.5
    assert np.array_equal(base, s.render(s.busy(executor, **change))["combined"])


@pytest.mark.parametrize("crop", [(0, 0, 96, 1), (13, 17, 64, 41), (95, 71, 96, 72)])
def test_crop_changes_no_bit(executor, crop):
    whole = s.render(s.busy(executor))["combined"]
    part = s.render(s.busy(executor, crop=np.array(crop, np.int32)))["combined"]
    assert np.array_equal(whole[crop[1] : crop[3], crop[0] : crop[2]], part)


def test_hidden_and_off_screen_geometry_changes_no_bit(executor):
    """M6: things behind an opaque wall, off screen, behind the camera, or degenerate."""

    def scene(extra):
        snapshot = s.busy(executor)
        wall = s.emission(snapshot, (0.3, 0.3, 0.3))
        s.quad(snapshot, [(-90, -90, 20), (90, -90, 20), (90, 90, 20), (-90, 90, 20)], wall)
        if extra:
            for dx, dz in [(0, 30), (500, 3), (0, -5)]:
                s.quad(
                    snapshot,
                    [(dx - 1, -1, dz), (dx + 1, -1, dz), (dx + 1, 1, dz), (dx - 1, 1, dz)],
                    wall,
                )
            s.quad(snapshot, [(0, 0, 3)] * 4, wall)
        return s.render(snapshot)["combined"]

    assert np.array_equal(scene(False), scene(True))


def test_order_of_objects_changes_no_bit(executor):
    """M8 holds where identities do: each object keeps its key."""

    def scene(reverse):
        snapshot = s.orthographic((32, 32), samples=16, executor=executor)
        items = [
            (s.rectangle(2 + i, 3 + i, 20 + i, 18 + i, 10 - i), (i / 5, 1 - i / 5, 0.5))
            for i in range(6)
        ]
        for points, color in reversed(items) if reverse else items:
            s.quad(snapshot, points, s.emission(snapshot, color))
        return s.render(snapshot)["combined"]

    assert np.array_equal(scene(False), scene(True))


@pytest.mark.parametrize("alpha", [None, 0.6], ids=["opaque", "transparent"])
@pytest.mark.parametrize("executor", ["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
def test_ties_in_depth_fall_to_the_smaller_key_whichever_comes_first(executor, alpha):
    """M8 where depths are the same: six sheets in one plane, some of them moving, each with its own key."""
    keys = [40, 7, 23, 61, 5, 18]
    colors = np.random.default_rng(1).uniform(0.1, 1, (6, 3)).astype(np.float32)

    def scene(order):
        sampling = "REGULAR" if executor == "RASTER" else "INDEPENDENT"
        snapshot = s.orthographic(
            (24, 24), samples=16, executor=executor, sampling=sampling, opacity_threshold=1.0
        )
        for i in order:
            moves = [s.translation(0, 0), s.translation(0, 0)] if i % 2 else None
            material = s.emission(snapshot, colors[i], alpha)
            s.quad(snapshot, s.rectangle(2, 3, 20, 18, 5), material, transforms=moves)
        snapshot["instances"]["key"] = [keys[i] for i in order]
        return s.render(snapshot)["combined"]

    pictures = [scene(order) for order in (range(6), range(5, -1, -1), (3, 0, 5, 1, 4, 2))]
    assert np.array_equal(pictures[0], pictures[1])
    assert np.array_equal(pictures[0], pictures[2])
    # By rising key, the nearer first: what is left for the i-th sheet is .4^i of its .6.
    front_to_back = colors[np.argsort(keys)]
    part = np.array([1.0] + [0.0] * 5) if alpha is None else 0.6 * 0.4 ** np.arange(6)
    assert np.abs(pictures[0][6:15, 6:17, :3] - part @ front_to_back).max() <= 1e-6


def test_far_from_the_origin_nothing_changes(executor):
    """Case 48: camera and scene shifted by 1e8 m together; differences are composed in double, relative to the camera."""

    def scene(shift):
        snapshot = s.perspective((48, 48), 40.0, samples=16, executor=executor)
        offset = np.array([shift, -shift, 0.5 * shift])
        snapshot["camera"]["world_from_camera"] = s.translation(*offset)[None]
        motion = [
            s.translation(*(offset + (-0.25, 0, 4))),
            s.translation(*(offset + (0.25, 0.125, 4))),
        ]
        s.quad(snapshot, s.rectangle(-1, -1, 1, 1, 0), s.emission(snapshot), transforms=motion)
        return s.render(snapshot)["combined"]

    assert np.array_equal(scene(0.0), scene(2.0**26))


def test_area_and_centroid_of_anything_translating(executor):
    """I0 and I1: with a box filter, the sum of alpha is the projected area, the centroid moves by the mean motion."""
    snapshot = s.orthographic((64, 64), samples=256, executor=executor)
    points = [(10, 12, 1), (25, 9, 1), (30, 28, 1), (18, 22, 1), (8, 30, 1)]  # concave
    transforms = [s.translation(0, 0), s.translation(12, 20)]
    s.mesh(snapshot, points, [(0, 1, 2, 3, 4)], s.emission(snapshot), transforms=transforms)
    image = s.alpha(snapshot)
    p = np.array(points)[:, :2]
    x, y = p.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2
    center = np.array(
        [((x + np.roll(x, -1)) * cross).sum(), ((y + np.roll(y, -1)) * cross).sum()]
    ) / (6 * area)
    assert abs(image.sum() - area) <= 2e-3 * area
    ys, xs = np.mgrid[0:64, 0:64] + 0.5
    found = np.array([(image * xs).sum(), (image * ys).sum()]) / image.sum()
    assert np.abs(found - center - (6, 10)).max() <= 0.02


def test_spread_of_anything_translating(executor):
    """I2: covariances of object, filter (a box of a pixel: 1/12) and way (length^2 / 12 along it) add up."""
    snapshot = s.orthographic((64, 64), samples=256, executor=executor)
    way = np.array([12.0, 20.0])
    transforms = [s.translation(0, 0), s.translation(*way)]
    s.quad(snapshot, s.rectangle(9, 7, 27, 19), s.emission(snapshot), transforms=transforms)
    image = s.alpha(snapshot)
    places = np.mgrid[0:64, 0:64][::-1].reshape(2, -1) + 0.5  # x, y
    found = np.cov(places, aweights=image.ravel(), ddof=0)
    expected = np.diag([18.0**2, 12.0**2]) / 12 + np.eye(2) / 12 + np.outer(way, way) / 12
    # 256 samples of 216 pixels' area, each 10 pixels from the middle: 10^2 / sqrt(256 * 216) = .43 if they were
    # random; those of the table come within .04.
    assert np.abs(found - expected).max() <= 0.07


@pytest.mark.parametrize("moving", [False, True], ids=["still", "moving"])
@pytest.mark.parametrize("executor", ["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
def test_whole_pixels_of_translation_shift_the_image(executor, moving):
    """M7, for REGULAR, whose lattice is the same in every pixel.

    With a filter of one pixel; a wider one sums over tiles of 16 pixels in their order, which rounds otherwise elsewhere
    (to 4e-7), except by whole tiles.
    """
    lattice = {"sampling": "REGULAR", "samples": 16, "time_samples": 8}
    corners = [(20.3125, 22.125), (45.75, 19.4375), (50.25, 48.9375), (28.625, 42.1875)]

    def picture(dx, dy, pixel_filter):
        snapshot = s.orthographic(
            (96, 80),
            executor=executor,
            **lattice,
            pixel_filter=pixel_filter,
            filter_width=WIDTHS[pixel_filter],
        )
        points = [(x + dx, y + dy, 1) for x, y in corners]
        way = [s.translation(0, 0), s.translation(7.25, 3.125)] if moving else None
        s.mesh(snapshot, points, [(0, 1, 2, 3)], s.emission(snapshot), transforms=way)
        return s.render(snapshot)["combined"]

    for pixel_filter, shifts in (("BOX", [(5, 3), (17, 9)]), ("MITCHELL", [(16, 16)])):
        still = picture(0, 0, pixel_filter)[8:60, 8:70]
        assert np.ptp(still[..., 3]) > 0.9
        for dx, dy in shifts:
            shifted = picture(dx, dy, pixel_filter)[8 + dy : 60 + dy, 8 + dx : 70 + dx]
            assert np.array_equal(still, shifted), (pixel_filter, dx, dy)
