# SPDX-License-Identifier: GPL-3.0-or-later
"""What shines without being a lamp."""

import numpy as np
import pytest
import snapshots as s


def plain(snapshot):
    """Adds a material that reflects; returns its index."""
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.5, 0.5, 0.5, 1)}}]
    snapshot["materials"].append({"name": "Plain", "nodes": nodes, "surface": (0, "BSDF")})
    return len(snapshot["materials"]) - 1


def brighter_in_mirrors(snapshot, strength):
    """What tells rays apart is no lamp."""
    nodes = [
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {
            "type": "ShaderNodeMath",
            "properties": {"operation": "ADD"},
            "inputs": {"Value": strength, "Value_001": ("LINK", 0, "Is Glossy Ray")},
        },
        {
            "type": "ShaderNodeEmission",
            "inputs": {"Color": (1,) * 4, "Strength": ("LINK", 1, "Value")},
        },
    ]
    index = len(snapshot["materials"])
    snapshot["materials"].append({"name": "Mirrored", "nodes": nodes, "surface": (2, "Emission")})
    return index


def warnings_of(strength, reflecting, varying=True):
    snapshot = s.orthographic((16, 16), samples=1, executor="SIMD")
    if varying:
        shining = brighter_in_mirrors(snapshot, strength)
    else:
        shining = s.emission(snapshot, color=(strength,) * 3)
    s.quad(snapshot, s.rectangle(0, 0, 8, 16), shining)
    if reflecting:
        s.quad(snapshot, s.rectangle(8, 0, 16, 16), plain(snapshot))
    done = s.render(snapshot)
    assert np.allclose(done["combined"][8, 2, :3], strength, rtol=1e-6)
    return [(datablock, count) for datablock, _, count in done["warnings"]]


@pytest.mark.parametrize("strength, reflecting, varying", [(5.0, True, False), (5.0, False, True)])
def test_nobody_misses_light_of_a_lamp_or_that_nothing_would_reflect(strength, reflecting, varying):
    assert warnings_of(strength, reflecting, varying) == []


def test_an_emitting_material_that_lights_nothing_is_named_once():
    assert warnings_of(5.0, True) == [("material 'Mirrored'", 1)]


def test_what_is_no_number_is_left_out_and_named():
    """exp(500) beside a plain square, with a filter that reaches over."""
    snapshot = s.orthographic(
        (16, 16),
        samples=1,
        executor="SIMD",
        pixel_filter="GAUSSIAN",
        passes=["Combined", "Emission"],
    )
    broken = s.emission(snapshot)
    power = {"type": "ShaderNodeMath", "inputs": {"Value": 500.0}}
    power["properties"] = {"operation": "EXPONENT"}
    nodes = snapshot["materials"][broken]["nodes"]
    nodes.insert(0, power)
    nodes[1]["inputs"]["Strength"] = ("LINK", 0, "Value")
    snapshot["materials"][broken]["surface"] = (1, "Emission")
    s.quad(snapshot, s.rectangle(0, 0, 8, 16), broken)
    s.quad(snapshot, s.rectangle(8, 0, 16, 16), s.emission(snapshot))
    done = s.render(snapshot)
    shown = done["combined"][2:-2, :, :3]  # the frame's own edge is see-through
    assert np.allclose(shown[:, 12:-2], 1.0) and (shown[:, :5] == 0).all()
    assert np.isfinite(done["combined"]).all() and np.isfinite(done["passes"]["Emission"]).all()
    ((datablock, message, count),) = done["warnings"]
    assert datablock == "material 'Emission 0'" and "not finite" in message and count > 0
