# SPDX-License-Identifier: GPL-3.0-or-later
"""Where rays go that mirrors and glass bend, by ray geometry: Snell's law, Fresnel's formulae, Hero's mirror."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import material, mirror

IOR = 1.5
SIZE = 64
LIMITS = {"glossy_bounces": 100, "transmission_bounces": 100, "clamp_indirect": 0.0}


def view(bounces, **options):
    limits = {**LIMITS, "filter_glossy": 0.0, "refractive_caustics": True}
    return s.orthographic((SIZE, 16), samples=64, bounces=bounces, **limits, **options)


def glass(snapshot):
    inputs = {"Color": (1,) * 4, "Roughness": 0.0, "IOR": IOR}
    return material(snapshot, [{"type": "ShaderNodeBsdfGlass", "inputs": inputs}], (0, "BSDF"))


def solid(snapshot, outline, surface):
    """What stands on an outline in x and z, counter-clockwise where x goes right and z up, from y = -40 to 60."""
    n = len(outline)
    points = [(x, y, z) for y in (-40.0, 60.0) for x, z in outline]
    sides = [(i, n + i, n + (i + 1) % n, (i + 1) % n) for i in range(n)]
    return s.mesh(
        snapshot,
        points,
        [*sides, tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1))],
        surface,
    )


def edge(snapshot, x, z):
    """What shines from x on, at a depth."""
    s.quad(snapshot, s.rectangle(x, -400, 4000, 400, z), s.emission(snapshot))


def fresnel(cosine):
    """What an unpolarized ray loses to reflection: (parallel + perpendicular) / 2."""
    inner = np.sqrt(1 - (1 - cosine**2) / IOR**2)
    across = (cosine - IOR * inner) / (cosine + IOR * inner)
    along = (IOR * cosine - inner) / (IOR * cosine + inner)
    return (across**2 + along**2) / 2


def profile(snapshot):
    """[SIZE] along x."""
    return s.render(snapshot)["combined"][..., 0].mean(0)


@pytest.mark.parametrize("tilt", [0.0, 0.5, -0.9])
def test_a_slab_shifts_an_edge(tilt):
    """By t sin(a - b) / cos b, and by 2 t sin b cos a / cos b more for each time that light goes to and fro within; what
    reaches the eye loses to each face what Fresnel says."""
    thick, place = 12.0, 32.3
    snapshot = view(bounces=8)
    c, n = np.cos(tilt), np.sin(tilt)
    along, across = np.array([c, n]), np.array([-n, c])
    corners = [(-400, -thick / 2), (400, -thick / 2), (400, thick / 2), (-400, thick / 2)]
    outline = [(SIZE / 2, 600.0) + u * along + v * across for u, v in corners]
    solid(snapshot, outline, glass(snapshot))
    edge(snapshot, place, 1200.0)
    inner = np.arcsin(np.sin(tilt) / IOR)
    shift = thick * np.sin(tilt - inner) / np.cos(inner)
    more = 2 * thick * np.tan(inner) * np.cos(tilt)
    lost = fresnel(np.cos(tilt))
    pixels = np.arange(SIZE)
    truth = np.zeros(SIZE)
    for k in range(4):
        at = place + shift - k * more
        truth += (1 - lost) ** 2 * lost ** (2 * k) * np.clip(pixels + 1 - at, 0, 1)
    # A pixel in which the edge lies has 1,024 samples in its column: .016 of it at most.
    np.testing.assert_allclose(profile(snapshot), truth, atol=0.02)


def test_a_prism_turns_what_passes_it():
    """Straight in by one face, out by the other, away from its edge: by the difference of the two angles there."""
    angle, wall, place = 0.4, 300.0, 60.0
    snapshot = view(bounces=2)
    # Its edge is left of the picture; thicker to the right, by the tangent of its angle.
    reach, front = 1000.0, 100.0
    left = -20.0
    outline = [(left, front), (left + reach, front), (left + reach, front + reach * np.tan(angle))]
    solid(snapshot, outline, glass(snapshot))
    edge(snapshot, place, wall)
    turned = np.arcsin(IOR * np.sin(angle)) - angle
    pixels = np.linspace(0, SIZE, 64 * SIZE + 1)[:-1] + 0.5 / 64
    leaves = front + (pixels - left) * np.tan(angle)
    lit = pixels + (wall - leaves) * np.tan(turned) > place
    inner = np.cos(np.arcsin(IOR * np.sin(angle)))
    weight = (1 - fresnel(1.0)) * (1 - fresnel(inner))
    truth = weight * lit.reshape(SIZE, 64).mean(1)
    np.testing.assert_allclose(profile(snapshot), truth, atol=0.02)


def test_an_edge_in_a_mirror_that_turns():
    """What a mirror shows goes twice as far as the mirror turns."""
    turn, depth, wall, place = 0.05, 100.0, -50.0, 30.0
    snapshot = view(bounces=2, light_samples=64)
    angles = np.linspace(-turn, turn, 9)
    ways = []
    for a in angles:
        m = np.eye(4)
        m[:3, :3] = [[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]]
        ways.append(s.translation(SIZE / 2, 8, depth) @ m)
    s.quad(snapshot, s.rectangle(-400, -400, 400, 400, 0.0), mirror(snapshot), transforms=ways)
    edge(snapshot, place, wall)
    x = np.arange(SIZE)[:, None, None] + (np.arange(8)[:, None] + 0.5) / 8
    a = -turn + 2 * turn * (np.arange(512) + 0.5) / 512
    meets = depth + (x - SIZE / 2) * np.tan(a)
    # From (0, 1) across a mirror whose normal is (sin a, -cos a).
    shown = x + (meets - wall) * np.tan(2 * a)
    truth = np.minimum((shown > place).mean((1, 2)), 1.0)
    seen = profile(snapshot)
    assert seen[:4] == pytest.approx(0.0, abs=1e-3) and seen[-4:] == pytest.approx(1.0, abs=1e-3)
    # Columns have 1,024 samples at times of their own: .5 / 32 of them at most.
    np.testing.assert_allclose(seen, truth, atol=3 * 0.016)
