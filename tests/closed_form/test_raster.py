# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole frames through OpenGL (the raster executor) against the CPU, from the same grids and the same samples."""

import numpy as np
import pytest
import snapshots as s

import granita_core

REGULAR = {"sampling": "REGULAR", "samples": 16, "time_samples": 1}


def rectangles(executor, **options):
    """Rectangles whose edges keep .05 px away from the 4 x 4 lattice: OpenGL's vertex grid of 2^-10 px moves no sample."""
    snapshot = s.orthographic((90, 70), executor=executor, **REGULAR, **options)
    for i, (x0, y0, x1, y1) in enumerate(
        [(-5, 9.3, 61.8, 40.2), (20.3, -9, 80.7, 66.55), (40.05, 20.3, 140, 30.7)]
    ):
        material = s.emission(snapshot, (0.2 + i, 3.0 - i, 0.5))
        s.quad(snapshot, s.rectangle(x0, y0, x1, y1, z=5.0 - i), material)
    return snapshot


def tilted(executor, **options):
    """A disc and planes in perspective that meet in lines."""
    snapshot = s.perspective((150, 100), 120.0, executor=executor, **REGULAR, **options)
    red, blue = s.emission(snapshot, (1, 0.2, 0.1)), s.emission(snapshot, (0.1, 0.5, 2))
    points, faces = s.disc(1.0, (0.2, 0.1), 4.0, 64)
    s.mesh(snapshot, points, faces, red)
    s.quad(snapshot, [(-3, -1, 3), (3, -1, 3), (3, -0.5, 9), (-3, -0.5, 9)], blue)
    s.quad(snapshot, [(-2.9, -3, 6), (3, -3, 5), (3, 3, 6.5), (-3, 3, 6)], red)
    return snapshot


def test_the_device_draws_and_the_cpu_tests_no_sample():
    statistics = s.render(rectangles("RASTER"))["statistics"]
    assert statistics["gl_primitives"] > 0
    assert statistics["gl_passes"] > 0
    assert statistics["sample_tests_static"] == statistics["sample_tests_moving"] == 0


def test_the_next_bucket_is_prepared_while_the_device_draws():
    """One thread for the CPU's work: it dices and shades during the device's seconds instead of waiting."""
    snapshot = tilted("RASTER", bucket_size=16, threads=1)
    statistics = s.render(snapshot)["statistics"]
    assert 0 < statistics["seconds_device_hidden"] <= statistics["seconds_device"]
    snapshot["options"]["executor"] = "SIMD"
    assert s.render(snapshot)["statistics"]["seconds_device"] == 0


@pytest.mark.parametrize("pixel_filter", s.FILTERS)
def test_filters_are_those_of_the_cpu(pixel_filter):
    options = {"pixel_filter": pixel_filter, "filter_width": s.FILTERS[pixel_filter]}
    raster = s.render(rectangles("RASTER", **options))["combined"]
    reference = s.render(rectangles("REFERENCE", **options))["combined"]
    assert np.ptp(reference[..., 3]) > 0.9
    # Sums of up to 24 x 24 terms of size 3 in float, in two orders: some ten roundings of 2^-24 each.
    assert np.abs(raster - reference).max() < 1e-5


def test_samples_differ_from_the_cpu_only_within_a_unit_of_an_edge():
    raster = s.render(tilted("RASTER"))["combined"]
    reference = s.render(tilted("REFERENCE"))["combined"]
    samples = np.abs(raster - reference)[..., 0] * 16
    # Silhouettes and lines of intersection are some 2,800 texels long: 2,800 * 2 / 256 samples lie within a unit of
    # 2^-8 texel on either side.
    assert (samples > 0.01).sum() < 2800 * 2 / 256
    assert np.median(samples) < 1e-4


@pytest.mark.parametrize(
    "change", [{"bucket_size": 16}, {"bucket_size": 32}, {"threads": 1}, {"threads": 3}], ids=str
)
def test_buckets_and_threads_change_no_bit(change):
    options = {"pixel_filter": "MITCHELL", "filter_width": 4.0}
    base = s.render(tilted("RASTER", **options))["combined"]
    assert np.array_equal(base, s.render(tilted("RASTER", **options, **change))["combined"])


def test_crop_changes_no_bit():
    options = {"pixel_filter": "MITCHELL", "filter_width": 4.0}
    whole = s.render(tilted("RASTER", **options))["combined"]
    x0, y0, x1, y1 = crop = (13, 17, 114, 69)
    part = s.render(tilted("RASTER", crop=np.array(crop, np.int32), **options))["combined"]
    assert np.array_equal(whole[y0:y1, x0:x1], part)


@pytest.mark.parametrize(
    "options", [REGULAR, {"samples": 4, "dicing_rate": 16}], ids=["regular", "independent"]
)
def test_hidden_grids_are_not_shaded(options):
    snapshot = s.orthographic((64, 64), executor="RASTER", **options)
    material = s.emission(snapshot)
    s.quad(snapshot, s.rectangle(-5, -5, 70, 70, z=1.0), material)
    alone = s.render(snapshot)["statistics"]["points_shaded"]
    for layer in range(9):
        s.quad(snapshot, s.rectangle(-5, -5, 70, 70, z=2.0 + layer), material)
    assert s.render(snapshot)["statistics"]["points_shaded"] == alone


@pytest.mark.parametrize(
    "options, reason",
    [
        ({"sampling": "REGULAR", "rolling_shutter": 0.1}, "the shutter rolls"),
        ({"passes": ["Normal"]}, "passes beside Combined and Depth"),
    ],
    ids=["rolling shutter", "passes"],
)
def test_what_it_cannot_render_is_refused_by_name(options, reason):
    snapshot = s.orthographic((8, 8), executor="RASTER", **options)
    with pytest.raises(granita_core.SceneError, match=f"raster executor.*{reason}"):
        s.render(snapshot)
