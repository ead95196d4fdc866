# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns finer than the corners that are to tell of them: lines between corners, and what keeps step with a grid."""

import numpy as np
import pytest
import snapshots as s
from session_parts import DOWN, sun
from test_bounces_hard_cases import white_world
from test_dense_meshes import turned

SIZE = 64


def math(operation, **values):
    return {"type": "ShaderNodeMath", "properties": {"operation": operation}, "inputs": values}


def striped(snapshot, period, part, shown, slope=0.0):
    """A material of lines that fill `part` of each `period` along x + slope * y: what is between them is black, or clear."""
    nodes = [
        {"type": "ShaderNodeNewGeometry", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Position")}},
        math("MULTIPLY", Value=("LINK", 1, "Y"), Value_001=slope),
        math("ADD", Value=("LINK", 1, "X"), Value_001=("LINK", 2, "Value")),
        math("DIVIDE", Value=("LINK", 3, "Value"), Value_001=period),
        math("ADD", Value=("LINK", 4, "Value"), Value_001=0.37),  # corners lie amid what is dark
        math("FRACT", Value=("LINK", 5, "Value")),
        math("GREATER_THAN", Value=("LINK", 6, "Value"), Value_001=1.0 - part),
    ]
    line, color = ("LINK", 7, "Value"), {"Color": (1.0, 1.0, 1.0, 1.0)}
    if shown == "emission":
        nodes.append({"type": "ShaderNodeEmission", "inputs": {"Color": line}})
    elif shown == "reflection":
        nodes.append({"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": line}})
    elif shown == "metal":
        blue = {"Color": (0.05, 0.05, 0.8, 1.0)}
        nodes.append({"type": "ShaderNodeBsdfDiffuse", "inputs": blue})
        metal = {**blue, "Roughness": 0.2}
        nodes.append({"type": "ShaderNodeBsdfAnisotropic", "inputs": metal})
        shaders = {"Shader": ("LINK", 8, "BSDF"), "Shader_001": ("LINK", 9, "BSDF")}
        nodes.append({"type": "ShaderNodeMixShader", "inputs": {"Fac": line, **shaders}})
    else:
        nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": color})
        nodes.append({"type": "ShaderNodeEmission", "inputs": color})
        shaders = {"Shader": ("LINK", 8, "BSDF"), "Shader_001": ("LINK", 9, "Emission")}
        nodes.append({"type": "ShaderNodeMixShader", "inputs": {"Fac": line, **shaders}})
    output = {"emission": "Emission", "reflection": "BSDF"}.get(shown, "Shader")
    snapshot["materials"].append(
        {"name": "Striped", "nodes": nodes, "surface": (len(nodes) - 1, output)}
    )
    return len(snapshot["materials"]) - 1


@pytest.mark.parametrize("shown", ["emission", "reflection", "opacity"])
@pytest.mark.parametrize("moved", [0.0, 20.0])
def test_lines_that_keep_step_with_micropolygons(shown, moved):
    """One a pixel, a quarter of it wide: no corner showed any."""
    snapshot = s.orthographic((SIZE, SIZE), samples=64, bounces=2)
    if shown == "reflection":
        white_world(snapshot)
    stripes = striped(snapshot, 1.0, 0.25, shown)
    knots = np.stack([s.translation(0, -moved / 2), s.translation(0, moved / 2)])
    corners = s.rectangle(-32, -32, 96, 96, 10.0)
    s.quad(snapshot, corners, stripes, transforms=knots if moved else None)
    seen = s.render(snapshot)["combined"][..., 3 if shown == "opacity" else 0]
    # 64 samples of a pixel, whose places along x are of strata
    assert np.abs(seen.mean(axis=0) - 0.25).max() < 0.01


def test_metal_is_told_from_paint_as_bright():
    """Stripes of both under a sun that metal does not mirror to the eye: corners saw paint alone."""
    means = []
    for part in (0.0, 0.25, 1.0):
        snapshot = s.orthographic((SIZE, SIZE), samples=64)
        sun(snapshot, turned(0.9, 0.0) @ DOWN, angle=0.01)
        stripes = striped(snapshot, 1.0, part, "metal")
        s.quad(snapshot, s.rectangle(-32, -32, 96, 96, 10.0), stripes)
        means.append(s.render(snapshot)["combined"][..., 2].mean(axis=0))
    paint, both, metal = means
    assert metal.max() < 0.3 * paint.min()
    assert both == pytest.approx(0.75 * paint + 0.25 * metal, rel=0.02)


@pytest.mark.parametrize("shown", ["emission", "reflection"])
@pytest.mark.parametrize("part", [0.04, 0.1, 0.3])
def test_lines_thinner_than_a_pixel_are_whole(shown, part):
    """A fifth of a pixel wide and more, every five pixels, askew: they were dashes."""
    snapshot = s.orthographic((SIZE, SIZE), samples=64, bounces=2)
    if shown == "reflection":
        white_world(snapshot)
    stripes = striped(snapshot, 5.0, part, shown, 0.13)
    s.quad(snapshot, s.rectangle(-64, -64, 128, 128, 10.0), stripes)
    seen = s.render(snapshot)["combined"][..., 0]
    x, y = np.meshgrid(*2 * [(np.arange(SIZE * 16) + 0.5) / 16])
    lines = (x + 0.13 * y) / 5.0 + 0.37
    truth = (lines - np.floor(lines) > 1.0 - part).reshape(SIZE, 16, SIZE, 16).mean(axis=(1, 3))
    assert seen.mean() == pytest.approx(part, rel=0.01)
    assert np.sqrt(((seen - truth) ** 2).mean()) < 0.03


@pytest.mark.parametrize("lit", ["world", "moving", "between holes"])
def test_what_no_corner_reflects_is_lit_by_others(lit):
    """Corners, all of them black, tell nothing of the light that samples take from them, whatever marked these."""
    snapshot = s.orthographic((SIZE, SIZE), samples=64, bounces=2)
    white_world(snapshot)
    stripes = striped(snapshot, 1.0, 0.25, "reflection")
    knots = None
    if lit == "moving":
        knots = np.stack([s.translation(-8.0), s.translation(8.0)])
    if lit == "between holes":
        nodes = snapshot["materials"][stripes]["nodes"]
        nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1.0,) * 4}})
        shaders = {"Shader": ("LINK", len(nodes) - 1, "BSDF"), "Shader_001": ("LINK", 8, "BSDF")}
        inputs = {"Fac": ("LINK", 7, "Value"), **shaders}
        nodes.append({"type": "ShaderNodeMixShader", "inputs": inputs})
        snapshot["materials"][stripes]["surface"] = (len(nodes) - 1, "Shader")
        s.quad(snapshot, s.rectangle(-9e3, -9e3, 9e3, 9e3, 30.0), s.emission(snapshot, (0, 0, 0)))
    s.quad(snapshot, s.rectangle(-32, -32, 96, 96, 10.0), stripes, transforms=knots)
    seen = s.render(snapshot)["combined"][..., 0]
    assert seen.mean() == pytest.approx(0.25, abs=0.01)


def test_what_corners_tell_costs_no_samples():
    """A slow wave is a pattern as well."""
    snapshot = s.orthographic((SIZE, SIZE), samples=16)
    nodes = [
        {"type": "ShaderNodeNewGeometry", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Position")}},
        math("MULTIPLY", Value=("LINK", 1, "X"), Value_001=0.05),
        math("SINE", Value=("LINK", 2, "Value")),
        math("MULTIPLY_ADD", Value=("LINK", 3, "Value"), Value_001=0.4, Value_002=0.5),
        {"type": "ShaderNodeEmission", "inputs": {"Color": ("LINK", 4, "Value")}},
    ]
    snapshot["materials"].append({"name": "Wave", "nodes": nodes, "surface": (5, "Emission")})
    s.quad(snapshot, s.rectangle(-64, -64, 128, 128, 10.0), 0)
    assert s.render(snapshot)["statistics"]["points_refined"] == 0


def test_stars_finer_than_a_pixel_are_seen():
    """A world of them, .4 pixels wide each and 4 apart: only those in which a pixel's corner lay were there."""
    focal, part = 1000.0, 0.1
    snapshot = s.perspective((SIZE, SIZE), focal, samples=64)
    s.constant_world(snapshot, 1.0)
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Generated")}},
    ]

    def along(axis):  # hardly bent: cosines are 1 within 1 / 1000
        first = len(nodes)
        scaled = {"Value": ("LINK", 1, axis), "Value_001": focal / 4.0, "Value_002": 0.43}
        nodes.append(math("MULTIPLY_ADD", **scaled))
        nodes.append(math("FRACT", Value=("LINK", first, "Value")))
        nodes.append(math("LESS_THAN", Value=("LINK", first + 1, "Value"), Value_001=part))
        return ("LINK", first + 2, "Value")

    both = {"Value": along("X"), "Value_001": along("Y")}
    nodes.append(math("MULTIPLY", **both))
    star = ("LINK", len(nodes) - 1, "Value")
    nodes.append({"type": "ShaderNodeBackground", "inputs": {"Color": star, "Strength": 1.0}})
    snapshot["world"].update(nodes=nodes, surface=(len(nodes) - 1, "Background"))
    seen = s.render(snapshot)["combined"][..., 0]
    assert seen.mean() == pytest.approx(part**2, rel=0.03)
