# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals bent by a height: slopes over the Filter Width."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse, mean

SIZE, SLOPE = 64, 0.7
CAGE = {"scheme": "CATMULL_CLARK", "boundary": "ALL", "uv_smooth": "PRESERVE_BOUNDARIES"}
# From the surface to the sun, z to the eye.
SUN = np.array([np.sin(1.0), 0.0, np.cos(1.0)])


def wavy(snapshot, period, slope, width):
    """A white material whose height is a sine along x."""
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
            "inputs": {"Height": ("LINK", 3, "Value"), "Distance": slope / turns, **width},
        },
        {
            "type": "ShaderNodeBsdfDiffuse",
            "inputs": {"Color": (1.0,) * 4, "Normal": ("LINK", 4, "Normal")},
        },
    ]
    snapshot["materials"].append({"name": "Waves", "nodes": nodes, "surface": (5, "BSDF")})
    return len(snapshot["materials"]) - 1


def sun(snapshot, towards):
    """Of radiance 1 on white that faces it."""
    axes = np.eye(4)
    axes[:3, 2] = towards
    axes[:3, 0] = np.cross((0, 1, 0), towards)
    axes[:3, 1] = np.cross(axes[:3, 2], axes[:3, 0])
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": axes[None], "energy": np.pi}
    ]


def waves(period, width, **options):
    """A plane whose height is a sine of so many pixels, of that slope at most, under a sun: light by column."""
    snapshot = s.orthographic((SIZE, SIZE), executor="SIMD", samples=64, **options)
    white = wavy(snapshot, period, SLOPE, width)
    s.quad(snapshot, s.rectangle(-100, -100, 164, 164, 10.0), white)
    sun(snapshot, SUN * (1, 1, -1))  # the camera looks along z
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


@pytest.mark.parametrize("camera", ["orthographic", "perspective"])
def test_bumps_that_light_others_are_as_fine_as_they_are_seen(camera):
    """A wavy plane behind the camera, in the sun, lights a white one before it, which casts no shadow.  Over the width of
    the diffuse rays that meet it there was no relief."""
    slope, far = 3.0, 50.0
    options = {"samples": 16, "light_samples": 64, "bounces": 1}
    if camera == "orthographic":
        snapshot = s.orthographic((16, 16), **options)
    else:
        snapshot = s.perspective((16, 16), far, **options)  # a pixel there is 1 wide, too
    white = wavy(snapshot, 8.0, slope, {"Filter Width": 0.1})
    s.quad(snapshot, s.rectangle(-9e3, -9e3, 9e3, 9e3, far), diffuse(snapshot, 1.0))
    s.quad(snapshot, s.rectangle(-9e3, -9e3, 9e3, 9e3, -1.0), white)
    snapshot["instances"]["flags"] = [121, 123]
    sun(snapshot, SUN * (1, 1, 1))
    x = np.linspace(0.0, 2 * np.pi, 10000, endpoint=False)
    truth = lit(slope * np.cos(x)).mean()
    assert abs(truth / lit(0.0) - 1.0) > 0.1
    assert mean(snapshot) == pytest.approx(truth, rel=0.02)
