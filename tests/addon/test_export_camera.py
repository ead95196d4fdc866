# SPDX-License-Identifier: GPL-3.0-or-later
"""Projection numbers worked out by hand."""

import numpy as np
import pytest
from export.base.transforms import has_area, inverse, world_from_camera
from export.scene.camera import Frame, lens_radius, other_projection, projection, sensor_size

HD = Frame(1920, 1080)


def test_landscape_frame_fits_its_width():
    # 36 mm of sensor see 1920 pixels through 50 mm: 1920 * 50 / 36.
    scale, center = projection(HD, "AUTO", 36 / 50, (0, 0))
    assert scale == pytest.approx((2666.6666666, 2666.6666666))
    assert center == (960, 540)


def test_portrait_frame_fits_its_height():
    scale, _ = projection(Frame(300, 600), "AUTO", 6.0, (0, 0))
    assert scale == pytest.approx((100, 100))


@pytest.mark.parametrize("fit, size", [("AUTO", 36), ("HORIZONTAL", 36), ("VERTICAL", 24)])
def test_sensor_side(fit, size):
    assert sensor_size(fit, 36, 24) == size


def test_vertical_fit_of_a_landscape_frame():
    # 1080 pixels * 50 mm / 24 mm
    assert projection(HD, "VERTICAL", 24 / 50, (0, 0))[0] == pytest.approx((2250, 2250))


def test_shift_is_in_units_of_the_fitted_side():
    # A quarter of 1920 to the right in the world is to the left in the picture.
    assert projection(HD, "AUTO", 1.0, (0.25, -0.1))[1] == pytest.approx((480, 732))
    assert projection(HD, "VERTICAL", 1.0, (0.25, 0))[1] == pytest.approx((690, 540))


def test_wide_pixels_see_as_much_with_half_as_many():
    # 100 x 100 pixels, each twice as wide as high: a frame of 200 by 100.
    scale, center = projection(Frame(100, 100, 2.0, 1.0), "AUTO", 0.5, (0.1, 0.1))
    assert scale == pytest.approx((200, 400))
    assert center == pytest.approx((40, 30))


def test_aspect_can_turn_the_fit_to_the_height():
    # 200 x 150 pixels, each three times as high as wide: 200 by 450.
    scale, _ = projection(Frame(200, 150, 1.0, 3.0), "AUTO", 1.0, (0, 0))
    assert scale == pytest.approx((450, 150))


def test_lens_radius():
    assert lens_radius("PERSPECTIVE", 50.0, 2.5) == pytest.approx(0.010)
    assert lens_radius("ORTHOGRAPHIC", 50.0, 2.5) == pytest.approx(0.2)
    assert np.isfinite(lens_radius("PERSPECTIVE", 50.0, 0.0))


def test_camera_matrix_drops_scale_and_looks_along_plus_z():
    matrix = np.diag([2.0, 3.0, 4.0, 1.0])
    matrix[:3, 3] = (7, 8, 9)
    expected = np.array([[1, 0, 0, 7], [0, 1, 0, 8], [0, 0, -1, 9], [0, 0, 0, 1]])
    assert np.array_equal(world_from_camera(matrix), expected)


@pytest.mark.parametrize("broken", [0.0, np.nan, np.inf])
def test_camera_without_extent(broken):
    assert world_from_camera(np.diag([1.0, broken, 1.0, 1.0])) is None


def test_area_survives_one_flat_axis_but_not_two():
    flat, line, point = np.diag([1, 1, 0, 1.0]), np.diag([1, 0, 0, 1.0]), np.diag([0, 0, 0, 1.0])
    assert has_area(np.stack([flat, line, point])).tolist() == [True, False, False]


@pytest.mark.parametrize("kind", ["PERSPECTIVE", "ORTHOGRAPHIC"])
def test_another_projection_is_another_space(kind):
    """Pixels of the changed space through the frame's projection are those of the other one."""
    at_frame = {"kind": kind, "scale": (100.0, 90.0), "center": (32.0, 24.0)}
    x, y, z, _ = other_projection(at_frame, (150.0, 135.0), (40.0, 20.0)) @ (0.3, -0.2, 2.0, 1.0)
    w = 2.0 if kind == "PERSPECTIVE" else 1.0
    assert z == 2.0
    assert 32.0 + 100.0 * x / w == pytest.approx(40.0 + 150.0 * 0.3 / w)
    assert 24.0 + 90.0 * y / w == pytest.approx(20.0 + 135.0 * -0.2 / w)


def test_inverse_of_an_affine_matrix():
    matrix = np.random.default_rng(1).normal(size=(4, 4))
    matrix[3] = (0, 0, 0, 1)
    assert inverse(matrix) @ matrix == pytest.approx(np.eye(4), abs=1e-12)
