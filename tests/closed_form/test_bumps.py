# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals bent by a height: slopes over the Filter Width."""

import numpy as np
import pytest
import snapshots as s

SIZE, SLOPE = 64, 0.7
SUN = np.array(
    [np.sin(1.0), 0.0, np.cos(1.0)]
)  # from the surface to the sun, y up and z to the eye


def waves(period, width, **options):
    """A white plane whose height is a sine of so many pixels, of that slope at most, under a sun: light by column."""
    snapshot = s.orthographic((SIZE, SIZE), executor="SIMD", samples=64, **options)
    turns = 2 * np.pi / period
    nodes = [
        {"type": "ShaderNodeNewGeometry", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Position")}},
        {
            "type": "ShaderNodeMath",
            "properties": {"operation": "MULTIPLY"},
            "inputs": {"Value": ("LINK", 1, "X"), "Value_001": turns},
        },
        {
            "type": "ShaderNodeMath",
            "properties": {"operation": "SINE"},
            "inputs": {"Value": ("LINK", 2, "Value")},
        },
        {
            "type": "ShaderNodeBump",
            "inputs": {"Height": ("LINK", 3, "Value"), "Distance": SLOPE / turns, **width},
        },
        {
            "type": "ShaderNodeBsdfDiffuse",
            "inputs": {"Color": (1.0,) * 4, "Normal": ("LINK", 4, "Normal")},
        },
    ]
    snapshot["materials"].append({"name": "Waves", "nodes": nodes, "surface": (5, "BSDF")})
    s.quad(snapshot, s.rectangle(-100, -100, 164, 164, 10.0), 0)
    towards = np.eye(4)
    towards[:3, 2] = SUN * (1, 1, -1)  # the camera looks along z
    towards[:3, 0] = np.cross((0, 1, 0), towards[:3, 2])
    towards[:3, 1] = np.cross(towards[:3, 2], towards[:3, 0])
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": towards[None], "energy": np.pi}
    ]
    return s.render(snapshot)["combined"][..., 0].mean(axis=0)


def lit(slope):
    """Of normals that lean against x by it, darkened where the surface itself would hide the sun from such slopes (Chiang,
    Li and Burley 2019)."""
    upright = 1.0 / np.sqrt(1.0 + slope**2)
    cosine = np.maximum((SUN[2] - slope * SUN[0]) * upright, 1e-9)
    g = np.minimum(SUN[2] / (cosine * upright), 1.0)
    return cosine * (-(g**3) + g**2 + g)


def columns(of_place, period):
    """Its mean over each pixel."""
    x = (np.arange(SIZE * 100) + 0.5) / 100
    return of_place(x, 2 * np.pi / period).reshape(SIZE, 100).mean(axis=1)


@pytest.mark.parametrize("period", [4.0, 16.0, 40.0])
def test_slopes_are_those_of_the_place(period):
    """Over a whole micropolygon they were those of half a pixel farther on: .05 of the light at 16 pixels."""
    seen = waves(period, {"Filter Width": 0.1})
    truth = columns(lambda x, turns: lit(SLOPE * np.cos(turns * x)), period)
    # Half of the width lies between the two: a slope that bends by turns * .05 at most.
    assert np.abs(seen - truth).max() <= 0.01 + SLOPE * 2 * np.pi / period * 0.05


@pytest.mark.parametrize("width, by_default", [(1.0, True), (4.0, False), (8.0, False)])
def test_a_wide_filter_smooths(width, by_default):
    """Differences over w pixels have sin(pi w / p) / (pi w / p) of the slope; before Blender 4.3 it is one pixel, whatever
    part of it a sample's own steps are."""
    period = 16.0
    seen = waves(period, {} if by_default else {"Filter Width": width}).mean()
    left = SLOPE * np.sinc(width / period)
    truth = columns(lambda x, turns: lit(left * np.cos(turns * x)), period).mean()
    assert seen == pytest.approx(truth, rel=0.004)
    assert truth > lit(SLOPE * np.cos(np.linspace(0, 2 * np.pi, 1001)[:-1])).mean()
