# SPDX-License-Identifier: GPL-3.0-or-later
"""Ribbons stand for tubes in the light: what falls on them, and what rays from elsewhere meet of them."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse, material, mirror
from test_elements import curves

ALBEDO = 0.8
RADIUS = 20.0
ROUGHNESS, RADIAL = 0.05, 0.6


def hair(snapshot, component):
    inputs = {"Color": (ALBEDO,) * 3 + (1.0,), "RoughnessU": ROUGHNESS, "RoughnessV": RADIAL}
    properties = {"component": component}
    nodes = [{"type": "ShaderNodeBsdfHair", "inputs": inputs, "properties": properties}]
    return material(snapshot, nodes, (0, "BSDF"))


def tube(snapshot, depth, surface):
    """Upright, wider than the picture is high."""
    places = [(32.0, y, depth) for y in (-40.0, 10.0, 54.0, 104.0)]
    curves(snapshot, places, [4], RADIUS, surface)


def mirror_behind(snapshot):
    across = np.array([(-8, -8, 100), (72, -8, 100), (72, 72, 100), (-8, 72, 100)], float)
    s.mesh(snapshot, across, [(0, 1, 2, 3)], mirror(snapshot))


@pytest.mark.parametrize(
    "component, mirrored", [("Reflection", False), ("Transmission", False), ("Transmission", True)]
)
def test_hair_in_a_furnace_has_its_albedo(component, mirrored):
    """At any place of its width: rays start beside it, whichever way they go, and lobes send light to all sides.  What is sent
    through the hair that a mirror shows does not come from the mirror."""
    snapshot = s.orthographic((64, 64), samples=16, bounces=1 if mirrored else 0, light_samples=64)
    if mirrored:
        mirror_behind(snapshot)
    tube(snapshot, -50.0 if mirrored else 20.0, hair(snapshot, component))
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    seen = s.render(snapshot)["combined"][..., 0].mean(axis=0)[14:50]
    assert seen.mean() == pytest.approx(ALBEDO, rel=0.005)
    # A column of what is mirrored has 64 points of a sample each, some of which meet the mirror.
    assert seen == pytest.approx(np.full(36, ALBEDO), rel=0.04 if mirrored else 0.005)


WHITE = (ALBEDO,) * 3 + (1.0,)
LOBES = {
    "Diffuse": {},
    "Glossy": {"Roughness": 0.2},
    "Glossy, sharp": {"Roughness": 0.0},
    "Refraction": {"Roughness": 0.2, "IOR": 1.3},
    "Refraction, sharp": {"Roughness": 0.0, "IOR": 1.3},
}


@pytest.mark.parametrize("radius", [0.3, 1.4, 3.5, 12.0])
@pytest.mark.parametrize("lobe", LOBES)
def test_round_hair_in_a_furnace_has_its_albedo(lobe, radius):
    """Points of ribbons know that they are round: what leaves below the flat ribbon is not lost, nor what its edges mirror
    behind it (a third of gloss was)."""
    snapshot = s.orthographic((64, 64), samples=64, bounces=1, light_samples=16)
    places = [(32.3, y, 20.0) for y in (-40.0, 10.0, 54.0, 104.0)]
    name = "ShaderNodeBsdf" + lobe.split(",")[0]
    inputs = {"Color": WHITE, **LOBES[lobe]}
    nodes = [{"type": name, "inputs": inputs, "properties": {"distribution": "MULTI_GGX"}}]
    curves(snapshot, places, [4], radius, material(snapshot, nodes, (0, "BSDF")))
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    seen = s.render(snapshot)["combined"][..., 0].mean(axis=0)
    missing = (1.0 - seen).sum() / (2.0 * radius)
    assert missing == pytest.approx(1.0 - ALBEDO, abs=0.01)


@pytest.mark.parametrize("angle", [-0.6, 0.25, 0.6])
@pytest.mark.parametrize("radius", [0.5, 1.4, 2.5, 3.5])
def test_the_sun_lights_a_part_of_ribbons_that_samples_shade(radius, angle):
    """As in a mirror below: each sample has the normal of its own place across."""
    snapshot = s.orthographic((64, 64), samples=256, bounces=1, light_samples=4)
    places = [(32.3, y, 20.0) for y in (-40.0, 10.0, 54.0, 104.0)]
    curves(snapshot, places, [4], radius, diffuse(snapshot, ALBEDO))
    angle *= np.pi
    turned = np.eye(4)
    turned[:3, 2] = (np.sin(angle), 0.0, -np.cos(angle))
    turned[:3, 0] = (np.cos(angle), 0.0, np.sin(angle))
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": turned[None], "energy": np.pi}
    ]
    seen = s.render(snapshot)["combined"][..., 0].mean(axis=0)
    phase = abs(angle)
    expected = ALBEDO * radius * (np.sin(phase) + (np.pi - phase) * np.cos(phase)) / 2
    # Half a pixel has the noise of its own coverage.
    assert seen.sum() == pytest.approx(expected, rel=0.02 if radius < 1.0 else 0.006)
    aside = (seen * (np.arange(64) + 0.5 - 32.3)).sum() / seen.sum() / radius
    assert radius < 1.0 or aside * np.sign(angle) > 0.3


def test_wide_hair_that_gathers_light_is_shaded_by_its_samples():
    """Of ribbons of three pixels a pixel sees few points, whose noise all of its samples would share."""

    def noise(samples):
        seen = []
        for seed in range(4):
            snapshot = s.orthographic((32, 32), samples=samples, bounces=1, light_samples=4)
            snapshot["options"]["seed"] = seed
            floor = np.array([(-8, -2, 60), (40, -2, 60), (40, -2, -60), (-8, -2, -60)], float)
            s.mesh(snapshot, floor, [(0, 1, 2, 3)], diffuse(snapshot, ALBEDO))
            s.constant_world(snapshot, 4.0)
            snapshot["world"]["lights_scene"] = True
            places = [(x, y, 20.0) for x in (6, 16, 26) for y in (-10.0, 10.0, 24.0, 50.0)]
            curves(snapshot, places, [4, 4, 4], 1.5, diffuse(snapshot, ALBEDO))
            seen.append(s.render(snapshot)["combined"][..., 0])
        return np.sqrt(np.var(seen, axis=0, ddof=1).mean())

    # .52 measured, as few samples are stratified over neighbouring pixels; .99 where points were shared.
    assert noise(128) < 0.65 * noise(8)


@pytest.mark.parametrize("angle", [-0.9, -0.5, 0.25, 0.5, 0.75])
def test_a_mirror_shows_a_tube_of_which_the_sun_lights_a_part(angle):
    """Lambert's tube at a phase a: (sin a + (pi - a) cos a) / 2 of a strip's light over its radius, on the sun's side."""
    snapshot = s.orthographic((64, 64), samples=16, bounces=1, light_samples=16)
    mirror_behind(snapshot)
    tube(snapshot, -50.0, diffuse(snapshot, ALBEDO))
    angle *= np.pi
    turned = np.eye(4)
    turned[:3, 2] = (np.sin(angle), 0.0, np.cos(angle))
    turned[:3, 0] = (np.cos(angle), 0.0, -np.sin(angle))
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": turned[None], "energy": np.pi}
    ]
    seen = s.render(snapshot)["combined"][..., 0].mean(axis=0)
    phase = abs(angle)
    expected = ALBEDO * RADIUS * (np.sin(phase) + (np.pi - phase) * np.cos(phase)) / 2
    # Mirrored rays leave from points a pixel apart: .04 where a narrow rim is all that is lit.
    assert seen.sum() == pytest.approx(expected, rel=0.015, abs=0.04)
    towards_sun = (seen * np.sign(angle) * (np.arange(64) + 0.5 - 32)).sum()
    assert towards_sun > 0.2 * RADIUS * seen.sum()


@pytest.mark.parametrize("upright", [False, True])
def test_a_mirror_shows_the_way_in_which_hair_lies(upright):
    """The lobe is a Cauchy density of half the inclination to the plane across it times one of the azimuth behind it."""
    snapshot = s.orthographic((64, 64), samples=16, bounces=1, light_samples=16)
    mirror_behind(snapshot)
    surface = hair(snapshot, "Transmission")
    along = (0.0, 1.0) if upright else (1.0, 0.0)
    places = [(32 + t * along[0], 32 + t * along[1], -50.0) for t in (-80.0, -20.0, 20.0, 80.0)]
    curves(snapshot, places, [4], RADIUS, surface)
    # From behind it, leaning towards +y by three quarters of a right angle.
    lean = 0.375 * np.pi
    turned = np.diag([-1.0, 1.0, 1.0, 1.0])
    turned[:3, 2] = (0.0, np.sin(lean), -np.cos(lean))
    turned[:3, 1] = (0.0, np.cos(lean), np.sin(lean))
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": turned[None], "energy": np.pi}
    ]
    seen = s.render(snapshot)["combined"][30:34, 30:34, 0].mean()
    inclination, azimuth = (lean, 0.0) if upright else (0.0, lean)

    def density(x, scale, most):
        return scale / (x**2 + scale**2) / (2 * np.arctan(most / scale))

    expected = density(inclination / 2, ROUGHNESS, np.pi / 4) / 2 / np.cos(inclination)
    expected *= density(azimuth, RADIAL, np.pi / 2)
    assert seen == pytest.approx(np.pi * ALBEDO * expected, rel=1e-3)


@pytest.mark.parametrize("angle", [-0.45, -0.25, 0.12, 0.25])
@pytest.mark.parametrize("deep", [0.25, 3.0])
@pytest.mark.parametrize("seen", ["few points", "samples", "in a mirror"])
def test_uneven_scale_bends_the_normals_of_a_tube(seen, deep, angle):
    """Its section is an ellipse, which hides no light from itself but where it turns away."""
    mirrored = seen == "in a mirror"
    snapshot = s.orthographic((64, 64), samples=64, bounces=1 if mirrored else 0, light_samples=16)
    if mirrored:
        mirror_behind(snapshot)
    width = 3.0 if seen == "samples" else 18.0
    depth = -50.0 if mirrored else 20.0
    flattened = np.diag([1.0, 1.0, deep, 1.0])
    flattened[:3, 3] = (0.3, 0.0, depth)
    places = [(32.0, y, 0.0) for y in (-40.0, 10.0, 54.0, 104.0)]
    curves(snapshot, places, [4], width, diffuse(snapshot, ALBEDO), flattened[None])
    angle *= np.pi
    away = 1.0 if mirrored else -1.0
    turned = np.eye(4)
    turned[:3, 2] = (np.sin(angle), 0.0, away * np.cos(angle))
    turned[:3, 0] = (np.cos(angle), 0.0, -away * np.sin(angle))
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": turned[None], "energy": np.pi}
    ]
    made = s.render(snapshot)["combined"][..., 0].mean(axis=0)
    u = (np.arange(10000) + 0.5) / 5000 - 1.0
    normal = np.stack([u, np.sqrt(1.0 - u * u) / deep])
    normal /= np.linalg.norm(normal, axis=0)
    lit = np.maximum(normal[0] * np.sin(angle) + normal[1] * np.cos(angle), 0.0)
    expected = 2.0 * width * ALBEDO * lit.mean()
    assert made.sum() == pytest.approx(expected, rel=0.02)
    aside = (made * (np.arange(64) + 0.5 - 32.3)).sum() / made.sum() / width
    assert aside == pytest.approx((lit * u).sum() / lit.sum(), abs=0.03)
