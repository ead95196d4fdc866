# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves of a few pixels that hide each other: samples are shaded by themselves, and what nobody sees is not."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse

SIZE, SIDE = 48, 2.5  # pixels
ALBEDO = 0.5


def leaves(snapshot, count, material, seed=5):
    """Squares at any turn between 3 and 43 pixels behind the picture, wider than which they spread."""
    random = np.random.default_rng(seed)
    centers = random.uniform((-8, -8, 3), (SIZE + 8, SIZE + 8, 43), (count, 3))
    axes = np.stack([np.linalg.qr(m)[0].T for m in random.normal(size=(count, 3, 2))])
    u, v = SIDE / 2 * axes[:, 0], SIDE / 2 * axes[:, 1]
    points = centers[:, None] + np.stack([-u - v, u - v, u + v, v - u], 1)
    faces = np.arange(4 * count).reshape(-1, 4).tolist()
    s.mesh(snapshot, points.reshape(-1, 3), faces, material)


def in_a_furnace(count=6000, **options):
    """Leaves that send out what they do not reflect."""
    limits = {"bounces": 8, "diffuse_bounces": 8, "clamp_indirect": 0.0}
    options = {"samples": 16, "light_samples": 16, "executor": "SIMD", **limits, **options}
    snapshot = s.orthographic((SIZE, SIZE), **options)
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    leaves(snapshot, count, diffuse(snapshot, ALBEDO, 1.0 - ALBEDO))
    return snapshot


def test_leaves_in_a_furnace_are_not_seen():
    """But for the noise of leaves as lamps to each other: .9976 to 1.0013 of six such pictures."""
    picture = s.render(in_a_furnace(samples=64, light_samples=64))["combined"][..., 0]
    assert picture.mean() == pytest.approx(1.0, abs=0.005)


def test_what_nobody_sees_is_not_shaded():
    """No more points than samples; they were half as many again, and more the more leaves."""
    statistics = s.render(in_a_furnace(count=12000))["statistics"]
    assert statistics["points_shaded"] < 16 * SIZE**2
    assert statistics["points_refined"] > 0.8 * statistics["points_shaded"]


@pytest.mark.parametrize(
    "options", [{"bucket_size": 16}, {"threads": 1}, {"crop": np.int32([4, 8, 20, 24])}]
)
def test_bits_do_not_depend_on_buckets_threads_or_crop(options):
    whole = s.render(in_a_furnace())["combined"]
    if "crop" in options:
        whole = whole[8:24, 4:20]
    assert np.array_equal(whole, s.render(in_a_furnace(**options))["combined"])
