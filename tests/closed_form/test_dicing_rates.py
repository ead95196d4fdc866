# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarser dicing of what is blurred, coarser shading of what is diced: what they save, and what they change."""

import numpy as np
import pytest
import snapshots as s


def stripes(snapshot, period):
    """A material of black and white squares, `period` pixels wide, in object space."""
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {
            "type": "ShaderNodeTexChecker",
            "inputs": {
                "Vector": ("LINK", 0, "Object"),
                "Color1": (1, 1, 1, 1),
                "Color2": (0, 0, 0, 1),
                "Scale": 1.0 / period,
            },
        },
        {"type": "ShaderNodeEmission", "inputs": {"Color": ("LINK", 1, "Color"), "Strength": 1.0}},
    ]
    index = len(snapshot["materials"])
    snapshot["materials"].append({"name": "Squares", "nodes": nodes, "surface": (2, "Emission")})
    return index


def picture(snapshot):
    result = s.render(snapshot)
    return result["combined"][..., 0], result["statistics"]


def expect_spared(all_points, fewer):
    """Of the statistics without and with a factor: most points are spared, and as many as is said."""
    assert fewer["points_diced"] < 0.4 * all_points["points_diced"]
    spared = all_points["points_diced"] - fewer["points_diced"]
    # Within the steps of a factor of two.
    assert 0.5 < fewer["points_spared"] / spared < 2.0
    assert all_points["points_spared"] == 0


@pytest.mark.parametrize("period", [40, 8, 3])
def test_motion_factor_spares_points_that_blur_hides(period):
    """A sheet of squares that goes 64 pixels: micropolygons four times as long along the way."""

    def render(factor, samples=256):
        snapshot = s.orthographic(
            (96, 64), executor="SIMD", samples=samples, dicing_rate=0.5, motion_factor=factor
        )
        way = [s.translation(-32, -3), s.translation(32, 3)]
        corners = s.rectangle(-60, -60, 160, 130)
        s.quad(snapshot, corners, stripes(snapshot, period), transforms=way)
        return picture(snapshot)

    fine, all_points = render(0.0)
    coarse, fewer = render(1.0)
    expect_spared(all_points, fewer)
    # A square's edge may lie half a micropolygon elsewhere: a 64th of the way, and of what crosses a place.
    assert np.sqrt(np.mean((coarse - fine) ** 2)) < 0.02


def test_motion_spares_what_lies_along_it_and_nothing_across():
    """A strip of 128 x 1 pixels goes 64: a quarter of its steps where it goes along itself."""

    def points(x, y):
        snapshot = s.orthographic((200, 100), executor="SIMD", samples=4)
        way = [s.translation(0, 0), s.translation(x, y)]
        s.quad(snapshot, s.rectangle(4, 10, 132, 11), s.emission(snapshot), transforms=way)
        return s.render(snapshot)["statistics"]["points_diced"]

    still = points(0, 0)
    assert points(0, 64) == still
    assert 0.2 * still < points(64, 0) < 0.3 * still


def test_what_no_row_of_a_rolling_shutter_blurs_is_diced_as_ever():
    def points(factor, rolling):
        snapshot = s.orthographic((96, 64), executor="SIMD", samples=4, motion_factor=factor)
        snapshot["options"]["rolling_shutter"] = rolling
        way = [s.translation(-32, -3), s.translation(32, 3)]
        s.quad(snapshot, s.rectangle(-60, -60, 160, 130), s.emission(snapshot), transforms=way)
        return s.render(snapshot)["statistics"]["points_diced"]

    assert points(1.0, 0.2) == points(0.0, 0.2) > points(1.0, 1.0)


def test_focus_factor_spares_points_that_the_lens_hides():
    def render(factor):
        snapshot = s.perspective(
            (96, 64), 100.0, executor="SIMD", samples=256, dicing_rate=0.5, focus_factor=factor
        )
        # The circle of confusion is 32 pixels wide.
        snapshot["camera"].update(lens_radius=0.32, focus_distance=1.0)
        corners = s.rectangle(-4, -3, 4, 3, 2.0)
        s.quad(snapshot, corners, stripes(snapshot, 0.2))
        return picture(snapshot)

    fine, all_points = render(0.0)
    coarse, fewer = render(1.0)
    expect_spared(all_points, fewer)
    assert np.sqrt(np.mean((coarse - fine) ** 2)) < 0.01


@pytest.mark.parametrize(
    "knots", [[(0.32, 1), (0.32, 3)], [(0, 1), (0.32, 1)]], ids=["rack focus", "opens"]
)
def test_what_is_sharp_for_a_moment_is_diced_as_ever(knots):
    def points(factor):
        snapshot = s.perspective((96, 64), 100.0, executor="SIMD", samples=4, focus_factor=factor)
        snapshot["camera"]["lens_knots"] = np.array(knots, float)
        s.quad(snapshot, s.rectangle(-4, -3, 4, 3, 2.0), s.emission(snapshot))
        return s.render(snapshot)["statistics"]["points_diced"]

    assert points(1.0) == points(0.0) > 1000


def test_what_stands_still_in_focus_is_diced_as_ever():
    def render(**factors):
        snapshot = s.perspective((64, 48), 60.0, executor="SIMD", samples=16, **factors)
        s.quad(snapshot, s.rectangle(-1, -1, 1, 1, 3.0), stripes(snapshot, 0.1))
        return s.render(snapshot)["combined"]

    assert np.array_equal(render(), render(motion_factor=0.0, focus_factor=0.0))


def test_shading_rate_shades_fewer_points_of_the_same_shapes(executor):
    def render(**options):
        snapshot = s.orthographic(
            (64, 48), executor=executor, samples=16, shading_threshold=1000, **options
        )
        nodes = [
            {"type": "ShaderNodeTexCoord", "inputs": {}},
            {
                "type": "ShaderNodeEmission",
                "inputs": {"Color": ("LINK", 0, "Object"), "Strength": 1.0},
            },
        ]
        snapshot["materials"].append({"name": "Place", "nodes": nodes, "surface": (1, "Emission")})
        s.quad(snapshot, s.rectangle(0, 0, 64, 48), 0)
        s.mesh(snapshot, *s.disc(11.3, (30, 20), 0.5), 0)
        result = s.render(snapshot)
        return result["combined"], result["statistics"]

    fine, all_points = render(dicing_rate=0.5)
    coarse, fewer = render(dicing_rate=0.5, shading_rate=4.0)
    assert fewer["micropolygons"] == all_points["micropolygons"]
    assert fewer["points_shaded"] < 0.1 * all_points["points_shaded"]
    assert np.array_equal(fine[..., 3], coarse[..., 3])
    # A colour that is linear is so between any points; but vertices that were moved onto a coarser side
    # have the colour of their old place, less than a micropolygon away.
    error = np.abs(fine - coarse).max(axis=-1)
    x, y = np.meshgrid(np.arange(64) + 0.5, np.arange(48) + 0.5)
    assert error[np.hypot(x - 30, y - 20) > 13].max() < 1e-3
    assert error.max() < 0.5


def pan(k):
    """A quarter turn about y, 0 to 1 of it."""
    turn = np.pi / 2 * (k - 0.5)
    return np.array(
        [
            [np.cos(turn), 0, np.sin(turn), 0],
            [0, 1, 0, 0],
            [-np.sin(turn), 0, np.cos(turn), 0],
            [0, 0, 0, 1],
        ]
    )


def dolly(k):
    return s.translation(0, 0, 3 * k)


@pytest.mark.parametrize("way", [pan, dolly])
def test_what_leaves_the_frame_is_diced_for_what_is_seen_of_it(way):
    """Walls on both sides and posts all around go through the eye plane within the shutter."""

    def render(rate, times):
        snapshot = s.perspective(
            (96, 72), 90.0, executor="SIMD", samples=64, dicing_rate=rate, shading_threshold=1000
        )
        material = stripes(snapshot, 0.5)
        for x in (-1.5, 1.5):
            s.quad(snapshot, [(x, -1, -5), (x, 1, -5), (x, 1, 20), (x, -1, 20)], material)
        for x in np.arange(-8.0, 9.0, 2.0):
            corners = np.array([(x, -1, 6), (x + 0.5, -1, 6), (x + 0.5, 1, 6), (x, 1, 6)])
            s.quad(snapshot, corners, material)
        snapshot["camera"]["world_from_camera"] = np.array([way(t) for t in times])
        return picture(snapshot)

    def difference(times):
        (fine, _), (coarse, points) = render(0.25, times), render(1.0, times)
        return np.sqrt(np.mean((coarse - fine) ** 2)), points["points_diced"]

    error, points = difference(np.linspace(0, 1, 13))
    still_error, still_points = difference([0.5])
    # The frame sees several times as much of the scene, and no pixel is finer than its own edges of squares.
    assert points < 5 * still_points
    assert error < still_error / 2


@pytest.mark.parametrize("blurred", ["motion", "lens"])
def test_blur_spares_light_samples_that_it_averages(blurred):
    """A wall in the penumbra of a lath, which only shadow rays see."""

    def render(light_samples, **camera):
        snapshot = s.perspective(
            (64, 64), 100.0, executor="SIMD", samples=256, light_samples=light_samples
        )
        snapshot["options"]["shading_threshold"] = 1000  # what the corners of micropolygons have
        snapshot["camera"].update(camera)
        lamp = {"name": "Lamp", "kind": "AREA", "energy": 500.0, "size": (2.0, 2.0)}
        lamp["world_from_light"] = np.diag([1.0, -1.0, -1.0, 1.0])[None]
        snapshot["lights"] = [lamp]
        s.quad(snapshot, s.rectangle(-9, -9, 9, 9, 4))
        s.quad(snapshot, s.rectangle(-9, -0.3, 9, 0.3, 2.0))
        snapshot["instances"]["flags"] = [3, 2]
        result = s.render(snapshot)
        return result["combined"][..., 0], result["statistics"]["rays_shadow"]

    def noise(**camera):
        (coarse, rays), (fine, _) = render(16, **camera), render(1024, **camera)
        error = coarse - fine
        return error.std(), error.reshape(16, 4, 16, 4).mean((1, 3)).std(), rays

    blurs = {
        # 20 pixels.
        "motion": {"world_from_camera": np.array([s.translation(x) for x in (-0.4, 0.4)])},
        # A circle of confusion of 12 pixels.
        "lens": {"lens_radius": 0.48, "focus_distance": 2.0},
    }
    pixel, square, rays = noise(**blurs[blurred])
    still_pixel, still_square, still_rays = noise()
    assert rays < 0.5 * still_rays
    assert pixel < still_pixel
    # As designed; one picture's noise of 256 such means is known to a twelfth or so.
    assert square < 1.3 * still_square


def test_what_lies_far_away_in_one_direction_takes_no_more(executor):
    """A face that runs to the horizon, nearly along the view: samples of its near end alone see it."""
    snapshot = s.perspective((32, 24), 30.0, samples=4, executor=executor)
    points = [(-0.2, 0.1, 4.0), (0.2, 0.1, 4.0), (0.2, 0.1, 1e12), (-0.2, 0.1, 1e12)]
    s.mesh(snapshot, points, [(0, 1, 2, 3)], s.emission(snapshot))
    result = s.render(snapshot)
    assert result["combined"][..., 3].sum() == pytest.approx(0.5 * 3.0 * 0.75, rel=0.25)
    assert result["statistics"]["micropolygons"] < 20_000
