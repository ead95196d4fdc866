# SPDX-License-Identifier: GPL-3.0-or-later
"""Panes of one surface, seen straight on through a camera that looks along +z."""

import numpy as np
import pytest
import snapshots as s

IOR = 1.5
STRAIGHT = ((IOR - 1) / (IOR + 1)) ** 2  # reflected where light meets glass straight on


def pane(
    snapshot, place, kind="ShaderNodeBsdfGlass", roughness=0.0, z=5.0, color=1.0, **properties
):
    """A square of 8 pixels, the `place`th from the left."""
    inputs = {"Color": (color,) * 3 + (1,), "Roughness": roughness, "IOR": IOR}
    node = {"type": kind, "inputs": inputs, "properties": properties}
    name = f"Pane {place}"
    snapshot["materials"].append({"name": name, "nodes": [node], "surface": (0, "BSDF")})
    x = 8 * place
    front = s.rectangle(x, 0, x + 8, 8, z)[::-1]
    s.quad(snapshot, front, len(snapshot["materials"]) - 1)


def white_world(snapshot):
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True


def means(snapshot, count, of="combined"):
    picture = s.render(snapshot)
    values = picture["combined"] if of == "combined" else picture["passes"][of]
    return [values[:, 8 * k + 2 : 8 * k + 6, 0].mean() for k in range(count)]


def test_white_glass_in_a_white_world_is_not_seen():
    """What is not reflected is let through; what facets lose to each other is made up for."""
    snapshot = s.orthographic((40, 8), samples=64, light_samples=64)
    white_world(snapshot)
    pane(snapshot, 0)
    pane(snapshot, 1, roughness=0.5, distribution="MULTI_GGX")
    pane(snapshot, 2, roughness=1.0, distribution="MULTI_GGX")
    pane(snapshot, 3, roughness=0.0, version=306)
    pane(snapshot, 4, kind="ShaderNodeBsdfRefraction")
    sharp, rough, roughest, old, refraction = means(snapshot, 5)
    assert sharp == pytest.approx(1.0, abs=1e-5)
    assert old == pytest.approx(1.0, abs=1e-5)
    assert refraction == pytest.approx(1.0, abs=1e-5)
    # Tables between places, and 64 samples of 64.
    assert rough == pytest.approx(1.0, abs=0.01)
    assert roughest == pytest.approx(1.0, abs=0.01)


def test_what_stands_behind_hides_the_world_from_light_that_is_let_through():
    snapshot = s.orthographic((16, 8), samples=16)
    white_world(snapshot)
    pane(snapshot, 0)
    pane(snapshot, 1, kind="ShaderNodeBsdfTranslucent", color=0.6)
    black = {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0, 0, 0, 1)}}
    snapshot["materials"].append({"name": "Black", "nodes": [black], "surface": (0, "BSDF")})
    s.quad(snapshot, s.rectangle(-1e4, -1e4, 1e4, 1e4, 9.0), 2)
    glass, translucent = means(snapshot, 2)
    assert glass == pytest.approx(STRAIGHT, abs=1e-4)
    assert translucent == pytest.approx(0.0, abs=1e-3)


def test_a_sun_behind_translucent_and_refracting_panes():
    """Lambert's cosine of the far side; and, through facets, light that is in the pass of its own."""
    snapshot = s.orthographic((16, 8), samples=16, passes=["Transmission Direct", "Diffuse Direct"])
    pane(snapshot, 0, kind="ShaderNodeBsdfTranslucent", color=0.6)
    pane(snapshot, 1, kind="ShaderNodeBsdfRefraction", roughness=0.6)
    matrix = np.eye(4)  # shines along -z, against the view
    snapshot["lights"] = [
        {"name": "Sun", "kind": "SUN", "world_from_light": matrix[None], "energy": 3.0}
    ]
    translucent, refracted = means(snapshot, 2)
    assert translucent == pytest.approx(0.6 * 3.0 / np.pi, rel=1e-4)
    # Straight through, the half vector is the normal: D = 1 / (pi alpha^2), no facet masked, and
    # half vectors are ior^2 / (ior - 1)^2 times as dense as directions.
    alpha2 = 0.6**4
    through = 3.0 * IOR**2 / (IOR - 1) ** 2 / (np.pi * alpha2)
    assert refracted == pytest.approx(through, rel=1e-3)
    in_pass = means(snapshot, 2, "Transmission Direct")
    assert in_pass[0] == 0.0
    assert in_pass[1] == pytest.approx(through, rel=1e-3)
    assert means(snapshot, 2, "Diffuse Direct")[0] == pytest.approx(3.0 / np.pi, rel=1e-4)
