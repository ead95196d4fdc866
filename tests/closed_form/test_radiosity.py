# SPDX-License-Identifier: GPL-3.0-or-later
"""Light between diffuse surfaces, where radiosity has a closed form."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse
from test_glass import white_world

LIMITS = {"diffuse_bounces": 100, "clamp_indirect": 0.0}


def hemisphere(snapshot, surface, center, radius, steps=48):
    """The half of a sphere that lies deeper than its middle, of whole quads towards its pole."""
    down = np.linspace(0, np.pi / 2, steps + 1)
    around = np.arange(2 * steps) * np.pi / steps
    ring = np.stack([np.cos(around), np.sin(around)], 1)
    rows = [np.column_stack([np.cos(a) * ring, np.full(2 * steps, np.sin(a))]) for a in down[:-1]]
    points = np.concatenate([*rows, [[0, 0, 1]]]) * radius + center
    n = 2 * steps
    faces = [
        (n * i + j, n * (i + 1) + j, n * (i + 1) + (j + 1) % n, n * i + (j + 1) % n)
        for i in range(steps - 1)
        for j in range(n)
    ]
    faces += [(n * (steps - 1) + j, n * steps, n * (steps - 1) + (j + 1) % n) for j in range(n)]
    s.mesh(snapshot, points, faces, surface, smooth=np.ones(len(faces), np.uint8))


@pytest.mark.parametrize("albedo", [0.5, 0.9])
@pytest.mark.parametrize("bounces", [0, 1, 4])
def test_a_bowl_in_a_furnace(albedo, bounces):
    """Each point of a sphere sees every other alike: half of what a hemisphere sees is itself, wherever."""
    snapshot = s.orthographic((48, 48), samples=16, bounces=bounces, light_samples=64, **LIMITS)
    white_world(snapshot)
    hemisphere(snapshot, diffuse(snapshot, albedo), (24, 24, 40.0), 22.0)
    seen = s.render(snapshot)["combined"][..., 0]
    rows, columns = np.mgrid[0:48, 0:48] + 0.5
    distance = np.hypot(rows - 24, columns - 24)
    expected = albedo / 2 * sum((albedo / 2) ** k for k in range(bounces + 1))
    inner = seen[distance < 20]
    assert inner.mean() == pytest.approx(expected, rel=0.005)
    for low, high in ((0, 8), (8, 16), (16, 20)):
        ring = seen[(distance >= low) & (distance < high)]
        assert ring.mean() == pytest.approx(expected, rel=0.01), (low, high)


@pytest.mark.parametrize("bounces", [0, 1, 2, 4])
def test_two_plates(bounces):
    """Endless and parallel, one of which shines: each sees the other alone."""
    lower, upper, shines = 0.7, 0.5, 1.5
    snapshot = s.orthographic((16, 16), samples=16, bounces=bounces, light_samples=64, **LIMITS)
    reach = 4e3
    s.quad(
        snapshot, s.rectangle(-reach, -reach, reach, reach, 20.0)[::-1], diffuse(snapshot, lower)
    )
    s.quad(
        snapshot,
        s.rectangle(-reach, -reach, reach, reach, -20.0),
        diffuse(snapshot, upper, shines),
    )
    # What emits is met one bounce further than what reflects.
    met = [lower ** ((j + 1) // 2) * upper ** (j // 2) for j in range(1, bounces + 2, 2)]
    seen = s.render(snapshot)["combined"][..., 0]
    assert seen.mean() == pytest.approx(shines * sum(met), rel=0.005)
