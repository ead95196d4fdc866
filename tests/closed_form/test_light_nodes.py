# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights whose nodes tell directions or places apart."""

import numpy as np
import pytest
import snapshots as s
from snapshots import link

SIZE, POWER, HEIGHT = 32, 4e4, 40.0
ALBEDO = 0.8


# Shines by the cosine to its axis, twice as strong in green.
COSINE = [
    {"type": "ShaderNodeTexCoord", "inputs": {}},
    {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Normal")}},
    {
        "type": "ShaderNodeMath",
        "inputs": {"Value": link(1, "Z"), "Value_001": -1.0},
        "properties": {"operation": "MULTIPLY", "use_clamp": 1.0},
    },
    {
        "type": "ShaderNodeEmission",
        "inputs": {"Color": (1.0, 2.0, 1.0, 1.0), "Strength": link(2, "Value")},
    },
]


def stage(turn, **light):
    """A floor before the camera, and a lamp between them that is turned about x."""
    snapshot = s.orthographic((SIZE, SIZE), executor="SIMD", samples=64, light_samples=4)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (ALBEDO,) * 3 + (1,)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    s.quad(snapshot, s.rectangle(-9, -9, SIZE + 9, SIZE + 9, 60.0), 0)
    place = np.eye(4)
    # Along +z, to the floor, where it is not turned.
    place[:3, :3] = [
        [1.0, 0.0, 0.0],
        [0.0, -np.cos(turn), np.sin(turn)],
        [0.0, -np.sin(turn), -np.cos(turn)],
    ]
    place[:3, 3] = SIZE / 2, SIZE / 2, 60.0 - HEIGHT
    snapshot["lights"] = [
        {
            "name": "Lamp",
            "kind": "POINT",
            "world_from_light": place[None],
            "energy": POWER,
            "color": (1.0, 1.0, 1.0),
            "nodes": COSINE,
            "surface": (3, "Emission"),
            **light,
        }
    ]
    return snapshot, -place[:3, 2]


@pytest.mark.parametrize("radius", [0.0, 0.01])
@pytest.mark.parametrize("turn", [0.0, 0.7, -0.9])
def test_a_lamp_that_shines_by_the_cosine(turn, radius):
    snapshot, axis = stage(turn, radius=radius)
    image = s.render(snapshot)["combined"][..., :3]
    x, y = np.meshgrid(np.arange(SIZE) + 0.5 - SIZE / 2, np.arange(SIZE) + 0.5 - SIZE / 2)
    way = np.stack([x, y, np.full_like(x, HEIGHT)], axis=-1)
    distance = np.linalg.norm(way, axis=-1)
    cosine = np.maximum(way @ axis, 0.0) / distance
    expected = ALBEDO / np.pi * POWER / (4 * np.pi) * cosine * HEIGHT / distance**3
    # Corners of micropolygons are a pixel apart, a fortieth of the height: (1 / 40)^2 of the light.
    np.testing.assert_allclose(image[..., 0], expected, atol=0.001 * expected.max())
    np.testing.assert_allclose(image[..., 1], 2 * image[..., 0], rtol=1e-5)


def test_instances_of_a_lamp_share_what_one_is():
    snapshot, _ = stage(0.4)
    alone = s.render(snapshot)["combined"]
    snapshot["lights"] *= 2
    np.testing.assert_allclose(s.render(snapshot)["combined"][..., 1], 2 * alone[..., 1], rtol=1e-5)


@pytest.mark.parametrize("output, power", [("Quadratic", 0), ("Linear", 1), ("Constant", 2)])
@pytest.mark.parametrize("smooth", [0.0, 500.0])
@pytest.mark.parametrize("radius", [0.0, 0.01])
def test_falloff(output, power, smooth, radius):
    snapshot, _ = stage(0.0, radius=radius)
    falloff = {"Strength": 0.02, "Smooth": smooth}
    snapshot["lights"][0] |= {
        "nodes": [
            {"type": "ShaderNodeLightFalloff", "inputs": falloff},
            {"type": "ShaderNodeEmission", "inputs": {"Strength": link(0, output)}},
        ],
        "surface": (1, "Emission"),
    }
    image = s.render(snapshot)["combined"][..., 0]
    x, y = np.meshgrid(np.arange(SIZE) + 0.5 - SIZE / 2, np.arange(SIZE) + 0.5 - SIZE / 2)
    distance = np.sqrt(x**2 + y**2 + HEIGHT**2)
    factor = 0.02 * distance**power * distance**2 / (distance**2 + smooth)
    expected = ALBEDO / np.pi * POWER / (4 * np.pi) * factor * HEIGHT / distance**3
    np.testing.assert_allclose(image, expected, rtol=0.002)


def slide(column, row):
    """A slide whose brightness grows along u and is cut off beyond half of v."""
    return column * (row > 0.5)


# Of an area lamp by Texture Coordinate's UV.
SLIDE = [
    {"type": "ShaderNodeTexCoord", "inputs": {}, "properties": {"version": 400}},
    {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "UV")}},
    {
        "type": "ShaderNodeMath",
        "inputs": {"Value": link(1, "Y"), "Value_001": 0.5},
        "properties": {"operation": "GREATER_THAN"},
    },
    {
        "type": "ShaderNodeMath",
        "inputs": {"Value": link(1, "X"), "Value_001": link(2, "Value")},
        "properties": {"operation": "MULTIPLY"},
    },
    {"type": "ShaderNodeEmission", "inputs": {"Strength": link(3, "Value")}},
]


@pytest.mark.parametrize("shape", ["RECTANGLE", "ELLIPSE"])
def test_a_lamp_with_a_slide(shape):
    """Each place of it shines as the slide there says."""
    size = np.array([50.0, 30.0])
    snapshot, axis = stage(
        0.3,
        kind="AREA",
        shape=shape,
        size=tuple(size),
        nodes=SLIDE,
        surface=(4, "Emission"),
    )
    snapshot["options"]["light_samples"] = 1024
    image = s.render(snapshot)["combined"][..., 0]
    steps = 200
    grid = (np.arange(steps) + 0.5) / steps
    u, v = (a.ravel() for a in np.meshgrid(grid, grid))
    inside = np.ones_like(u) if shape == "RECTANGLE" else np.hypot(u - 0.5, v - 0.5) < 0.5
    area = size.prod() * (1.0 if shape == "RECTANGLE" else np.pi / 4)
    place = snapshot["lights"][0]["world_from_light"][0]
    points = place[:3, 3] + ((u - 0.5) * size[0])[:, None] * place[:3, 0]
    points = points + ((v - 0.5) * size[1])[:, None] * place[:3, 1]
    radiance = POWER / (np.pi * area) * slide(u, v) * inside * size.prod() / steps**2
    for x, y in [(2, 3), (16, 16), (29, 10), (8, 28)]:
        way = points - np.array([x + 0.5, y + 0.5, 60.0])
        distance = np.linalg.norm(way, axis=-1)
        cosines = np.abs(way[:, 2]) / distance * np.maximum(-(way @ axis) / distance, 0.0)
        expected = ALBEDO / np.pi * np.sum(radiance * cosines / distance**2)
        # 1024 well spread samples at each corner of a pixel, half of them across an edge: .15 % were seen.
        assert image[y, x] == pytest.approx(expected, rel=0.004), (x, y)


def with_slide(turn=0.3, samples=1024, **light):
    snapshot, _ = stage(
        turn,
        **{"kind": "AREA", "size": (50.0, 30.0), "nodes": SLIDE, "surface": (4, "Emission")},
        **light,
    )
    snapshot["lights"][0]["shape"] = "RECTANGLE"
    snapshot["options"]["light_samples"] = samples
    return snapshot


def test_a_slide_that_moves_is_the_mean_of_its_places():
    snapshot = with_slide(samples=256)
    there = snapshot["lights"][0]["world_from_light"][0].copy()

    def at(x):
        place = there.copy()
        place[0, 3] += x
        return place

    snapshot["lights"][0]["world_from_light"] = np.stack([at(-20.0), at(20.0)])
    moving = s.render(snapshot)["combined"][..., 0]
    still = []
    for x in np.linspace(-20.0, 20.0, 8, endpoint=False) + 2.5:
        snapshot["lights"][0]["world_from_light"] = at(x)[None]
        still.append(s.render(snapshot)["combined"][..., 0])
    average = np.mean(still, axis=0)
    assert moving.mean() == pytest.approx(average.mean(), rel=0.003)
    # 256 samples, each at a time of its own: .022 was seen.
    np.testing.assert_allclose(moving, average, rtol=0.04)


def test_many_slides_are_the_sum_of_each():
    """More lamps than are all asked: some are chosen by what they may give."""
    snapshot = with_slide(samples=64)
    one = snapshot["lights"][0]
    rng = np.random.default_rng(5)
    lamps = []
    for i in range(20):
        place = one["world_from_light"][0].copy()
        place[:2, 3] += rng.uniform(-60.0, 60.0, 2)
        lamps.append(
            {**one, "name": f"Lamp{i}", "size": (12.0, 8.0), "world_from_light": place[None]}
        )
    snapshot["lights"] = lamps
    together = s.render(snapshot)["combined"][..., 0]
    alone = np.zeros_like(together)
    for lamp in lamps:
        snapshot["lights"] = [lamp]
        alone += s.render(snapshot)["combined"][..., 0]
    assert together.mean() == pytest.approx(alone.mean(), rel=0.002)
    # 64 samples of each light: .027 was seen.
    np.testing.assert_allclose(together, alone, rtol=0.05)
