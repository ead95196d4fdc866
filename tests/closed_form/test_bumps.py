# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals bent by a height: slopes over the Filter Width."""

import numpy as np
import pytest
import snapshots as s

SIZE, SLOPE = 64, 0.7
CAGE = {"scheme": "CATMULL_CLARK", "boundary": "ALL", "uv_smooth": "PRESERVE_BOUNDARIES"}
# From the surface to the sun, z to the eye.
SUN = np.array([np.sin(1.0), 0.0, np.cos(1.0)])


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


@pytest.mark.parametrize("width, period", [(None, 3.2), (1.0, 3.2), (4.0, 16.0), (8.0, 16.0)])
def test_a_wide_filter_smooths(width, period):
    """Differences over w pixels have sin(pi w / p) / (pi w / p) of the slope.  Before Blender 4.3 w is one, whatever part of
    a pixel a sample's own steps are."""
    seen = waves(period, {} if width is None else {"Filter Width": width}).mean()

    def mean(slope):
        return columns(lambda x, turns: lit(slope * np.cos(turns * x)), period).mean()

    truth = mean(SLOPE * np.sinc((width or 1.0) / period))
    assert seen == pytest.approx(truth, rel=0.004)
    assert abs(truth / mean(SLOPE) - 1.0) > 0.009  # a filter that does nothing is told apart


@pytest.mark.parametrize("width", [0.1, 4.0])
def test_a_bump_does_not_turn_the_tangents_of_a_map(width):
    """Of a subdivision surface they are made of the map's differences along the grid, which is seen from the side here
    and has other steps along u than along v; the map lies askew on it."""

    def seen(bumped):
        snapshot = s.orthographic((SIZE, SIZE), executor="SIMD", samples=16)
        nodes = [
            {
                "type": "ShaderNodeNormalMap",
                "properties": {"space": "TANGENT"},
                "inputs": {"Color": (0.9, 0.5, 0.8, 1.0)},
            }
        ]
        if bumped:
            height = {"Height": 0.5, "Filter Width": width, "Normal": ("LINK", 0, "Normal")}
            nodes.append({"type": "ShaderNodeBump", "inputs": height})
        normal = ("LINK", len(nodes) - 1, "Normal")
        nodes.append({"type": "ShaderNodeEmission", "inputs": {"Color": normal}})
        surface = (len(nodes) - 1, "Emission")
        snapshot["materials"].append({"name": "Askew", "nodes": nodes, "surface": surface})
        corners = [(-100, -100, 10), (164, -100, 1000), (164, 164, 1000), (-100, 164, 10)]
        uv = np.float32([(0, 0), (1, 1), (0, 2), (-1, 1)])
        record = {"name": "UVMap", "domain": "CORNER", "kind": "UV", "values": uv}
        s.quad(snapshot, corners, 0, subdivision=CAGE, attributes=[record])
        return s.render(snapshot)["combined"][16:48, 16:48, :3]

    assert np.abs(seen(True) - seen(False)).max() < 1e-3
    assert np.ptp(seen(False).mean(axis=(0, 1))) > 0.1
