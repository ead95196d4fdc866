# SPDX-License-Identifier: GPL-3.0-or-later
"""Floors lit by a world alone: images, and what is drawn beside them."""

import numpy as np
import pytest
import snapshots as s

ALBEDO = 0.8


def link(node, socket):
    return ("LINK", node, socket)


def stage(nodes, image):
    """A floor that looks along -z of the world, whose last node is its background."""
    snapshot = s.orthographic((32, 32), samples=64)
    matte = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (ALBEDO,) * 3 + (1,)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": matte, "surface": (0, "BSDF")})
    s.quad(snapshot, s.rectangle(-50, -50, 90, 90, 20.0), 0)
    pixels = np.ones((*image.shape, 4), np.float32)
    pixels[..., :3] = image[..., None]
    snapshot["images"] = [
        {
            "name": "I",
            "path": "",
            "colorspace": "Linear",
            "alpha_mode": "STRAIGHT",
            "pixels": pixels,
        }
    ]
    surface = (len(nodes) - 1, "Background")
    snapshot["world"] = {"name": "World", "nodes": nodes, "surface": surface}
    return snapshot


COORDINATES = {"type": "ShaderNodeTexCoord", "inputs": {}}
ENVIRONMENT = {
    "type": "ShaderNodeTexEnvironment",
    "inputs": {"Vector": link(0, "Generated")},
    "properties": {"image": "I"},
}


def background(color):
    return {"type": "ShaderNodeBackground", "inputs": {"Color": color, "Strength": 1.0}}


@pytest.mark.parametrize("rows", [8, 100, 1024])
def test_an_image_lights_by_its_integral(rows):
    """Rows of any brightness, interpolated between their middles; the floor sees the lower half."""
    level = np.random.default_rng(rows).uniform(0.0, 1.0, rows).astype(np.float32)
    level[rows // 4] = 20.0
    snapshot = stage(
        [COORDINATES, ENVIRONMENT, background(link(1, "Color"))],
        np.repeat(level[:, None], 2 * rows, axis=1),
    )
    v = (np.arange(200_000) + 0.5) / 400_000  # from the lower pole to the horizon
    seen = np.interp(v * rows - 0.5, np.arange(rows), level)
    polar = np.pi * v
    irradiance = np.mean(seen * np.cos(polar) * np.sin(polar)) * 2 * np.pi * np.pi / 2
    mean = s.render(snapshot)["combined"][..., 0].mean()
    assert mean == pytest.approx(ALBEDO * irradiance / np.pi, rel=0.01)


@pytest.mark.parametrize("radius", [0.02, 0.005, 0.0025])
def test_a_disc_drawn_over_an_image_keeps_its_light(radius):
    """Of an irradiance of 1 across its rays; the smaller ones are narrower than a texel of the world's table."""
    way = np.array([0.3113, -0.2217, -0.9])
    way /= np.linalg.norm(way)
    math = "ShaderNodeMath"
    nodes = [
        COORDINATES,
        ENVIRONMENT,
        {
            "type": "ShaderNodeVectorMath",
            "inputs": {"Vector": link(0, "Generated"), "Vector_001": tuple(way)},
            "properties": {"operation": "DOT_PRODUCT"},
        },
        {
            "type": math,
            "inputs": {"Value": link(2, "Value"), "Value_001": np.cos(radius)},
            "properties": {"operation": "GREATER_THAN"},
        },
        {
            "type": math,
            "inputs": {
                "Value": link(3, "Value"),
                "Value_001": 1 / (2 * np.pi * (1 - np.cos(radius))),
            },
            "properties": {"operation": "MULTIPLY"},
        },
        {
            "type": "ShaderNodeMixRGB",
            "inputs": {"Fac": 1.0, "Color1": link(4, "Value"), "Color2": link(1, "Color")},
            "properties": {"blend_type": "ADD"},
        },
        background(link(5, "Color")),
    ]
    mean = s.render(stage(nodes, np.full((16, 32), 0.02, np.float32)))["combined"][..., 0].mean()
    expected = ALBEDO / np.pi * -way[2] + ALBEDO * 0.02
    # Sixteen light samples a point, of which few meet what is narrower than a texel.
    assert mean == pytest.approx(expected, rel=0.05)
