# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that go by their attributes alone are asked nothing else: the same to the bit as where a node that reads the
place is there and counts for nothing."""

import numpy as np
import pytest
import snapshots as s
from snapshots import link
from test_patterns import math

SIZE = (64, 48)


def waves(reads_place):
    """(nodes, index of the last): sine waves along an attribute, times what a place makes of 1 where it is read."""
    nodes = [
        {"type": "ShaderNodeAttribute", "inputs": {}, "properties": {"attribute_name": "Place"}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Vector")}},
        math("MULTIPLY", Value=link(1, "X"), Value_001=40.0),
        math("SINE", Value=link(2, "Value"), Value_001=0.0),
        math("MULTIPLY", Value=link(3, "Value"), Value_001=0.4),
        math("ADD", Value=link(4, "Value"), Value_001=0.5),
    ]
    if reads_place:
        nodes += [
            {"type": "ShaderNodeNewGeometry", "inputs": {}},
            {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(6, "Position")}},
            math("MULTIPLY", Value=link(7, "X"), Value_001=0.0),
            math("ADD", Value=link(5, "Value"), Value_001=link(8, "Value")),
        ]
    return nodes, len(nodes) - 1


def picture(kind, reads_place, executor="SIMD", lit=True, moves=False):
    """A sheet of four squares whose emission, or opacity, waves, over a matte floor under a lamp."""
    snapshot = s.orthographic(SIZE, executor=executor, samples=16)
    matte = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": matte, "surface": (0, "BSDF")})
    nodes, last = waves(reads_place)
    wave = link(last, "Value")
    if kind == "sent":
        nodes.append({"type": "ShaderNodeEmission", "inputs": {"Strength": wave}})
        out = (len(nodes) - 1, "Emission")
    else:
        nodes.append({"type": "ShaderNodeBsdfTransparent", "inputs": {}})
        nodes.append({"type": "ShaderNodeEmission", "inputs": {"Strength": 0.3}})
        shaders = {
            "Fac": wave,
            "Shader": link(last + 1, "BSDF"),
            "Shader_001": link(last + 2, "Emission"),
        }
        nodes.append({"type": "ShaderNodeMixShader", "inputs": shaders})
        out = (len(nodes) - 1, "Shader")
    snapshot["materials"].append({"name": "Waves", "nodes": nodes, "surface": out})
    s.quad(snapshot, s.rectangle(-100, -100, 200, 200, 30.0), 0)
    motion = {"transforms": [s.translation(0), s.translation(6)]} if moves else {}
    corners = np.float32([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    place = {"name": "Place", "domain": "CORNER", "kind": "GENERIC", "values": corners}
    for x in (4, 34):
        s.quad(
            snapshot,
            s.rectangle(x, 6, x + 24, 40, 20.0),
            1,
            attributes=[place],
            **motion,
        )
    if lit:
        down = np.diag([1.0, -1.0, -1.0, 1.0])
        snapshot["lights"] = [
            {
                "name": "Sun",
                "kind": "SUN",
                "world_from_light": down[None],
                "energy": 2.0,
                "sun_angle": 0.1,
            }
        ]
    return s.render(snapshot)["combined"]


@pytest.mark.parametrize("kind", ["sent", "passed"])
@pytest.mark.parametrize("lit", [False, True])
@pytest.mark.parametrize("executor", ["SIMD", "COMPUTE"])
def test_what_reads_no_place_is_as_what_does(kind, lit, executor):
    """Emission, opacity, and the shadow that it casts; all three have waves finer than the quads' corners."""
    painted = picture(kind, False, executor, lit)
    assert np.std(painted[10:36, 6:26, 0]) > 0.05
    assert np.array_equal(painted, picture(kind, True, executor, lit))


def test_what_emits_is_the_same_with_a_lamp_beside_it():
    """Patterns of what reflects nothing are looked for with and without light in the frame."""
    sheet = np.s_[10:36, 6:26]
    assert np.array_equal(
        picture("sent", False, lit=True)[sheet], picture("sent", False, lit=False)[sheet]
    )


@pytest.mark.parametrize("kind", ["sent", "passed"])
def test_in_motion_too(kind):
    """What reads its place is asked at several times, whose samples then are its own."""
    painted, other = picture(kind, False, moves=True), picture(kind, True, moves=True)
    assert np.sqrt(np.mean((painted - other) ** 2)) < 0.01
