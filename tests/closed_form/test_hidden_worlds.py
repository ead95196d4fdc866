# SPDX-License-Identifier: GPL-3.0-or-later
"""A world that some of light's rays do not see, on surfaces that send several kinds of them."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import material

DIFFUSE, GLOSS = 0.6, 0.9


def floor(snapshot, diffuse, gloss):
    """Half of it diffuse, half of it rough gloss."""

    def bsdf(kind, color, **more):
        return {"type": kind, "inputs": {"Color": (color,) * 3 + (1.0,), **more}}

    return material(
        snapshot,
        [
            bsdf("ShaderNodeBsdfDiffuse", diffuse),
            bsdf("ShaderNodeBsdfGlossy", gloss, Roughness=0.5),
            {
                "type": "ShaderNodeMixShader",
                "inputs": {
                    "Fac": 0.5,
                    "Shader": ("LINK", 0, "BSDF"),
                    "Shader_001": ("LINK", 1, "BSDF"),
                },
            },
        ],
        (2, "Shader"),
    )


def under_a_gradient(hidden, diffuse=DIFFUSE, gloss=GLOSS, bounces=3, light_samples=16):
    """Mean of a floor below a world that `hidden` rays do not see, brighter to one side."""
    snapshot = s.orthographic(
        (16, 16), samples=16, bounces=bounces, light_samples=light_samples, clamp_indirect=0.0
    )
    s.quad(snapshot, s.rectangle(-8, -8, 24, 24, z=5.0), floor(snapshot, diffuse, gloss))
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {
            "type": "ShaderNodeVectorMath",
            "inputs": {
                "Vector": ("LINK", 0, "Generated"),
                "Vector_001": (0.5,) * 3,
                "Vector_002": (0.5,) * 3,
            },
            "properties": {"operation": "MULTIPLY_ADD"},
        },
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": 1.0, "Value_001": ("LINK", 2, hidden) if hidden else 0.0},
            "properties": {"operation": "SUBTRACT"},
        },
        {
            "type": "ShaderNodeBackground",
            "inputs": {"Color": ("LINK", 1, "Vector"), "Strength": ("LINK", 3, "Value")},
        },
    ]
    snapshot["world"] = {
        "name": "World",
        "nodes": nodes,
        "surface": (4, "Background"),
        "lights_scene": True,
    }
    return s.render(snapshot)["combined"][..., :3].mean()


@pytest.mark.parametrize("light_samples", [1, 4, 64])
@pytest.mark.parametrize("bounces", [0, 3])
@pytest.mark.parametrize(
    ("hidden", "seen"),
    [("Is Glossy Ray", {"gloss": 0.0}), ("Is Diffuse Ray", {"diffuse": 0.0})],
)
def test_what_is_hidden_is_hidden_from_its_own_lobe(hidden, seen, bounces, light_samples):
    """A plane meets nothing: as bright as one whose lobe that sees nothing is black, in a world that all rays see,
    however many rays are asked."""
    due = under_a_gradient(None, bounces=0, light_samples=256, **seen)
    made = under_a_gradient(hidden, bounces=bounces, light_samples=light_samples)
    # 4,096 samples of a world from 0 to 1 in three channels: at most .3 / sqrt(12288) of .5 are .5 %; thrice that.
    assert made == pytest.approx(due, rel=0.016)
    assert np.isfinite(made) and made > 0.1
