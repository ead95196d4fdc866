# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds are spheres in the light: what falls on them, and what rays from elsewhere meet of them."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse, material, mirror
from test_elements import cloud

ALBEDO = 0.8


@pytest.mark.parametrize("bounces", [0, 1])
@pytest.mark.parametrize("radius", [0.9, 2.4, 6.0, 15.0])
@pytest.mark.parametrize("rate", [1.0, 0.25])
def test_a_sphere_in_a_furnace_has_its_albedo(bounces, radius, rate):
    """Nothing hides the world from it: rays start outside of it, at any size and wherever dicing puts its vertices."""
    snapshot = s.orthographic((48, 48), samples=64, bounces=bounces, dicing_rate=rate)
    cloud(snapshot, [(23.7, 24.4, 20.0)], radius, diffuse(snapshot, ALBEDO))
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    snapshot["options"]["film_transparent"] = True
    seen = s.render(snapshot)["combined"]
    assert seen[..., 0].sum() / seen[..., 3].sum() == pytest.approx(ALBEDO, rel=0.02)
    inner = seen[seen[..., 3] == 1]
    assert (inner[..., 0].min() if len(inner) else ALBEDO) > 0.95 * ALBEDO


@pytest.mark.parametrize("angle", [0.5, 1.0])
def test_a_mirror_shows_a_sphere_of_which_the_sun_lights_a_part(angle):
    """Lambert's sphere at a phase of `angle`, parts of pi: 2/3 (sin a + (pi - a) cos a) / pi of what a disc would send.
    Where the sun stands behind it, none."""
    angle *= np.pi
    snapshot = s.orthographic((64, 64), samples=16, bounces=1, light_samples=64)
    across = np.array([(-8, -8, 100), (72, -8, 100), (72, 72, 100), (-8, 72, 100)], float)
    s.mesh(snapshot, across, [(0, 1, 2, 3)], mirror(snapshot))
    radius = 20.0
    cloud(snapshot, [(32.0, 32.0, -50.0)], radius, diffuse(snapshot, ALBEDO))
    # Its light goes along its own -z; the mirrored camera looks at the sphere from +z.
    turned = np.eye(4)
    turned[:3, 2] = (np.sin(angle), 0.0, np.cos(angle))
    turned[:3, 0] = (np.cos(angle), 0.0, -np.sin(angle))
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": turned[None], "energy": np.pi}
    ]
    phase = 2 / 3 * (np.sin(angle) + (np.pi - angle) * np.cos(angle)) / np.pi
    expected = ALBEDO * phase * np.pi * radius**2
    assert s.render(snapshot)["combined"][..., 0].sum() == pytest.approx(
        expected, rel=0.01, abs=0.01
    )


def clear(snapshot, passed):
    inputs = {"Color": (passed,) * 3 + (1.0,)}
    nodes = [{"type": "ShaderNodeBsdfTransparent", "inputs": inputs}]
    return material(snapshot, nodes, (0, "BSDF"))


@pytest.mark.parametrize("mirrored", [False, True])
def test_what_passes_a_point_passes_one_layer(mirrored):
    """Its front, as the camera sees it and as in Cycles: .6 of a sun's light in its shadow, and in a mirror."""
    passed, bounces = 0.6, 1 if mirrored else 0
    snapshot = s.orthographic((64, 64), samples=16, bounces=bounces, light_samples=16)
    shines = s.emission(snapshot)
    if mirrored:
        across = np.array([(-8, -8, 100), (72, -8, 100), (72, 72, 100), (-8, 72, 100)], float)
        s.mesh(snapshot, across, [(0, 1, 2, 3)], mirror(snapshot))
        s.quad(snapshot, s.rectangle(-8, -8, 72, 72, -80.0), shines)
    else:
        s.quad(snapshot, s.rectangle(-8, -8, 72, 72, 60.0), diffuse(snapshot, 1.0))
        down = np.diag([1.0, -1.0, -1.0, 1.0])
        sun = {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": np.pi}
        snapshot["lights"] = [sun]
    # Out of the camera's sight, between it and what it sees.
    cloud(snapshot, [(32.0, 32.0, -50.0 if mirrored else -30.0)], 16.0, clear(snapshot, passed))
    seen = s.render(snapshot)["combined"][..., 0]
    assert seen[28:36, 28:36].mean() == pytest.approx(passed * seen[2, 2], rel=0.01)
