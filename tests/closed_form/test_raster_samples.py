# SPDX-License-Identifier: GPL-3.0-or-later
"""Per-pixel time sampling through OpenGL (the chapter's figure 9.6): INDEPENDENT and INTERLEAVED on the raster executor.

Samples are those of the CPU, so pictures are its pictures: the test and the filter round alike, but for the table of
the filter's factor (1e-5) and depths within an ulp of each other where surfaces meet.  Dicing is coarse: a triangle
costs every sample around its way.
"""

import numpy as np
import pytest
import snapshots as s
from moving_edge import add_moving_edge
from test_raster_blur import busy_scene, render


@pytest.fixture(params=["INDEPENDENT", "INTERLEAVED"])
def sampling(request):
    return request.param


def simd(snapshot):
    snapshot["options"]["executor"] = "SIMD"
    return s.render(snapshot)["combined"]


@pytest.mark.parametrize("samples", [1, 7, 16])
@pytest.mark.parametrize("lens", [False, True, "moving"], ids=["pinhole", "lens", "moving"])
def test_a_busy_scene_is_that_of_the_cpu(sampling, lens, samples):
    """Moving, transparent, defocused, through three knots; sample numbers that fill no square too."""
    options = {
        "sampling": sampling,
        "samples": samples,
        "dicing_rate": 12,
        "opacity_threshold": 0.9,
    }
    snapshot = busy_scene("RASTER", lens, **options)
    matrices = snapshot["instances"]["world_from_object"]
    first = sum(snapshot["instances"]["knots"][:3])
    matrices.insert(first + 1, s.translation(0.1, 0.3))
    snapshot["instances"]["knots"][3] += 1
    picture = render(snapshot)
    error = np.abs(picture - simd(snapshot)).max(axis=2)
    assert np.ptp(picture[..., 3]) > 0.5
    # Ten thousandths of the samples may meet a surface within an ulp of another.
    assert np.mean(error > 2e-5) <= 1e-3
    assert np.median(error) < 2e-6


@pytest.mark.parametrize("pixel_filter", s.FILTERS)
def test_filters_are_those_of_the_cpu(pixel_filter):
    options = {"pixel_filter": pixel_filter, "filter_width": s.FILTERS[pixel_filter]}
    snapshot = s.orthographic((40, 30), samples=9, executor="RASTER", dicing_rate=30, **options)
    s.quad(snapshot, s.rectangle(-9, 4.3, 21.8, 22.2), s.emission(snapshot, (0.5, 2, 1)))
    picture = render(snapshot)
    assert np.ptp(picture[..., 3]) > 0.9
    assert np.abs(picture - simd(snapshot)).max() < 2e-5


def test_moving_edge(sampling):
    """Case 10; a class of INTERLEAVED repeats every 4 pixels: errors of neighbours are one error."""
    options = {"samples": 64, "sampling": sampling, "executor": "RASTER", "dicing_rate": 40}
    snapshot = s.orthographic((48, 8), **options)
    expected = np.broadcast_to(add_moving_edge(snapshot, 48, 20), (8, 48))
    error = render(snapshot)[..., 3] - expected
    # Four times the error of a (0,2)-net of 64 samples over 20 pixels (docs/sampling_error.md).
    assert np.abs(error).max() <= 4 * 0.0092
    assert error[expected == 0].max() == 0 and np.abs(error[expected == 1]).max() <= 1e-6


def test_through_the_near_plane(sampling):
    """Case 17: z = 2 - 3 t, near .1: .6333; the triangles' ways cross the eye."""
    options = {"samples": 256, "sampling": sampling, "executor": "RASTER", "dicing_rate": 200}
    snapshot = s.perspective((8, 4), 500.0, center=(-112.0, 2.0), **options)
    points, faces = s.disc(1.0, z=0.0, sides=64)
    move = [s.translation(0, 0, 2.0), s.translation(0, 0, -1.0)]
    s.mesh(snapshot, points, faces, s.emission(snapshot), transforms=move)
    # Times of 256 samples fill 256 strata: an interval's share errs by two of them at most.
    assert np.abs(render(snapshot)[..., 3] - 1.9 / 3).max() <= 2 / 256


def test_coincident_layers_and_many(sampling):
    """Cases 35 and 40."""
    options = {"samples": 4, "sampling": sampling, "executor": "RASTER", "dicing_rate": 60}
    snapshot = s.orthographic((16, 16), **options)
    for i in range(64):
        rectangle = s.rectangle(-40, -40, 60, 60, 1.0 + i // 2)
        s.quad(snapshot, rectangle, s.emission(snapshot, (1, 1, 1), 1 / 64))
    expected = 1 - (1 - 1 / 64) ** 64
    assert np.abs(render(snapshot)[..., 3] - expected).max() <= 64 * 2.0**-24


def test_moving_transparent_patch_has_no_seams(sampling):
    """Case 42 in motion."""
    options = {"samples": 9, "sampling": sampling, "executor": "RASTER", "dicing_rate": 6}
    snapshot = s.perspective((48, 48), 60.0, grid_size=16, **options)
    points = [(-4, -4, 2), (4, -4, 4), (4, 4, 5), (-4, 4, 2.5)]
    ends = [s.translation(-0.1, 0.05), s.translation(0.1, -0.02)]
    s.quad(snapshot, points, s.emission(snapshot, (1, 1, 1), 0.37), transforms=ends)
    assert np.abs(render(snapshot)[16:32, 16:32, 3] - 0.37).max() <= 1e-6


def test_depth_is_that_of_the_cpu(sampling):
    options = {"samples": 9, "sampling": sampling, "dicing_rate": 12, "depth_pass": True}
    snapshot = busy_scene("RASTER", **options)
    depth = s.render(snapshot)["depth"]
    snapshot["options"]["executor"] = "SIMD"
    expected = s.render(snapshot)["depth"]
    assert np.mean(expected < 100) > 0.3 and np.mean(expected > 100) > 0.05
    assert np.mean(np.abs(depth / expected - 1) > 1e-6) <= 1e-3


@pytest.mark.parametrize(
    "change",
    [{"bucket_size": 16}, {"threads": 3}, {"crop": np.array((13, 17, 64, 41), np.int32)}],
    ids=str,
)
def test_buckets_threads_and_crop_change_no_bit(change):
    def picture(**options):
        options = {"sampling": "INDEPENDENT", "samples": 5, "dicing_rate": 16, **options}
        return render(busy_scene("RASTER", **options))

    x0, y0, x1, y1 = change.get("crop", (0, 0, 96, 72))
    assert np.array_equal(picture()[y0:y1, x0:x1], picture(**change))
