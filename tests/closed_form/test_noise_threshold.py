# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples where the error is: tiles take few samples, and more where these leave them in doubt."""

import numpy as np
import pytest
import snapshots as s

TILE = 16


LEVELS = (4, 16, 64)


def render(executor="SIMD", **options):
    """With a threshold that some tiles of the busy scene meet with 4 samples, some with 16, some never."""
    options = {"samples": LEVELS[-1], "min_samples": LEVELS[0], "noise_threshold": 0.04, **options}
    return s.render(s.busy(executor, **options))


def tiles(picture):
    """[tiles][16][16][4]"""
    height, width = picture.shape[:2]
    return [
        picture[y : y + TILE, x : x + TILE]
        for y in range(0, height, TILE)
        for x in range(0, width, TILE)
    ]


@pytest.mark.parametrize("executor", ["SIMD", "COMPUTE"])
def test_a_tile_is_what_it_is_with_the_samples_that_it_takes(executor):
    """To the bit: what few samples culled is found again, and nothing of them is left.  A box filter keeps tiles apart."""
    box = {"pixel_filter": "BOX", "filter_width": 1.0}
    uniform = [tiles(s.render(s.busy(executor, samples=n, **box))["combined"]) for n in LEVELS]
    taken = []
    for i, tile in enumerate(tiles(render(executor, **box)["combined"])):
        same = [
            n for n, level in zip(LEVELS, uniform, strict=True) if np.array_equal(tile, level[i])
        ]
        assert same, f"tile {i}"
        taken.append(same[0])
    assert set(taken) == set(LEVELS)


def test_a_threshold_that_all_meet_takes_the_fewest_samples():
    few = s.render(s.busy("SIMD", samples=LEVELS[0]))
    all_meet = render(noise_threshold=1000.0)
    assert np.array_equal(all_meet["combined"], few["combined"])
    assert all_meet["statistics"]["tiles_resampled"] == 0
    assert all_meet["statistics"]["samples_total"] == few["statistics"]["samples_total"]


def test_no_threshold_costs_nothing():
    plain = s.render(s.busy("SIMD", samples=64))
    zero = s.render(s.busy("SIMD", samples=64, noise_threshold=0.0, min_samples=4))
    assert np.array_equal(zero["combined"], plain["combined"])
    for name in ("samples_total", "grids_diced", "micropolygons", "tiles_resampled"):
        assert zero["statistics"][name] == plain["statistics"][name]


def counts(result, size=(96, 72)):
    return result["statistics"]["samples_total"] / (size[0] * size[1])


@pytest.mark.parametrize(
    "change",
    [{"bucket_size": 16}, {"bucket_size": 128}, {"threads": 1}, {"threads": 3}, {"list_memory": 1}],
    ids=str,
)
def test_buckets_threads_and_parts_change_no_bit(change):
    assert np.array_equal(render()["combined"], render(**change)["combined"])


@pytest.mark.parametrize("crop", [(0, 0, 96, 1), (13, 17, 64, 41), (95, 71, 96, 72)])
def test_crop_changes_no_bit(crop):
    """Whole tiles decide, whatever part of them the crop wants."""
    whole = render()["combined"]
    part = render(crop=np.array(crop, np.int32))["combined"]
    assert np.array_equal(whole[crop[1] : crop[3], crop[0] : crop[2]], part)


@pytest.mark.parametrize("executor", ["COMPUTE", "REFERENCE"])
def test_executors_agree(executor):
    options = {"samples": 16, "noise_threshold": 0.1}
    simd, other = render(**options), render(executor, **options)
    assert simd["statistics"]["tiles_resampled"] > 0
    assert simd["statistics"]["samples_total"] == other["statistics"]["samples_total"]
    assert np.abs(simd["combined"] - other["combined"]).max() < 2e-6


def blurred_edge(**options):
    """(snapshot, its columns): an edge that moves over columns 40 to 72 of 96, and nothing elsewhere."""
    snapshot = s.orthographic((96, 32), **{"samples": 1024, **options})
    moves = [s.translation(-16), s.translation(16)]
    s.quad(
        snapshot, s.rectangle(56, -50, 300, 80), s.emission(snapshot, (0.5,) * 3), transforms=moves
    )
    columns = np.clip((np.arange(96) + 0.5 - 40) / 32, 0, 1)
    return snapshot, columns


def shown(values):
    return np.sqrt(np.maximum(values, 0))


@pytest.mark.parametrize("threshold", [0.02, 0.01, 0.005])
def test_the_error_that_is_left_is_the_threshold(threshold):
    """Of a ramp of motion, in the worst quarter of a tile: known to the third that 64 pixels tell."""
    snapshot, columns = blurred_edge(noise_threshold=threshold)
    picture = s.render(snapshot)["combined"]
    error = shown(picture) - shown(np.outer(columns, (0.5, 0.5, 0.5, 1.0)))[None]
    quarters = (error**2).reshape(4, 8, 12, 8, 4).mean(axis=(1, 3, 4))
    assert np.sqrt(quarters.max()) < 1.5 * threshold


def test_samples_go_where_the_blur_is():
    snapshot, _ = blurred_edge(noise_threshold=0.005)
    result = s.render(snapshot)
    # Three of six columns of tiles meet the ramp; the others are settled with 16 samples.
    assert 64 < counts(result, (96, 32)) < 1024 / 2
    still, _ = blurred_edge(noise_threshold=0.005)
    still["instances"]["knots"] = [1]
    still["instances"]["world_from_object"] = [s.translation(0)]
    assert counts(s.render(still), (96, 32)) == 16


def test_noise_of_light_takes_samples_too():
    """Soft shadows are shaded by samples: their tiles take more, the lit floor around them does not."""
    snapshot = s.orthographic((96, 32), samples=256, noise_threshold=0.004, light_samples=1)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8,) * 3 + (1,)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": 3.0}
    snapshot["lights"] = [{**sun, "sun_angle": 0.5}]
    snapshot["instances"]["flags"] = [1, 2]
    s.quad(snapshot, s.rectangle(-200, -200, 300, 200, 20.0), 0)
    s.quad(snapshot, s.rectangle(48, -300, 400, 300, 10.0), 0)
    result = s.render(snapshot)
    assert 16 < counts(result, (96, 32)) < 200
    lit = result["combined"][:, :16, 0]
    assert lit == pytest.approx(0.8 * 3.0 / np.pi, rel=0.02)


@pytest.mark.parametrize("option", [{"sampling": "REGULAR"}, {"executor": "RASTER"}], ids=str)
def test_where_it_is_not_read_that_is_said(option):
    snapshot = s.orthographic((16, 16), samples=4, min_samples=1, noise_threshold=0.02, **option)
    s.quad(snapshot, s.rectangle(2, 3, 9, 9), s.emission(snapshot))
    result = s.render(snapshot)
    assert any("Noise Threshold" in str(warning) for warning in result["warnings"])
    assert result["statistics"]["samples_total"] == 4 * 16 * 16


def test_min_samples_is_where_it_begins():
    assert counts(render(noise_threshold=1000.0, min_samples=16)) == 16
    assert counts(render(noise_threshold=1000.0, min_samples=17)) == 64
