# SPDX-License-Identifier: GPL-3.0-or-later
"""What deforms and turns at once meets itself where it is seen: a convex body casts no shadow on itself."""

import numpy as np
import pytest
import snapshots as s

SIDES = 24


def turned(angle):
    m = np.eye(4)
    m[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    m[:3, 3] = (16.0, 16.0, 30.0)
    return m


def ball(stretch):
    """An ellipsoid's vertices, and its faces outwards."""
    up = np.linspace(0.0, np.pi, SIDES // 2 + 1)[1:-1]
    around = np.arange(SIDES) * (2.0 * np.pi / SIDES)
    rings = [(np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)) for a in up for b in around]
    points = 10.0 * np.array([(0.0, 0.0, 1.0), *rings, (0.0, 0.0, -1.0)])
    faces, last = [], len(points) - 1
    for b in range(SIDES):
        c = (b + 1) % SIDES
        faces.append((0, 1 + b, 1 + c))
        for ring in range(len(up) - 1):
            low = 1 + ring * SIDES
            faces.append((low + b, low + SIDES + b, low + SIDES + c, low + c))
        faces.append((last, last - SIDES + c, last - SIDES + b))
    return points * (1.0 - 0.5 * stretch, 1.0, 1.0 + 0.6 * stretch), faces


def picture(turns, stretches, shadow, **options):
    snapshot = s.orthographic((32, 32), samples=16, **options)
    faces = ball(0.0)[1]
    knots = np.array([ball(stretch)[0] for stretch in stretches])
    white = {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (1, 1, 1, 1), "Roughness": 0.0}}
    snapshot["materials"].append({"name": "White", "nodes": [white], "surface": (0, "BSDF")})
    s.mesh(snapshot, knots, faces, 0, [turned(angle) for angle in turns])
    towards = np.eye(4)
    towards[:3, :3] = [[1, 0, 0], [0, np.cos(0.8), -np.sin(0.8)], [0, np.sin(0.8), np.cos(0.8)]]
    towards[:3, :3] = towards[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    lamp = {"name": "Sun", "kind": "SUN", "world_from_light": towards[None], "energy": 3.0}
    snapshot["lights"] = [lamp | {"casts_shadow": shadow}]
    return s.render(snapshot)["combined"][..., 0]


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("turns", [(-0.015, 0.015), (-0.15, 0.15), (-0.15, 0.0, 0.15)])
def test_a_convex_body_lies_in_no_shadow_of_its_own(turns, way):
    stretches = (0.3, 0.7)
    turns = [way * angle for angle in turns]
    # Fine: of points that stand for a pixel, some at edges that face the sun for a part of the shutter are shadowed,
    # where only the body turns as well.
    lit = picture(turns, stretches, False, dicing_rate=0.25)
    assert lit.max() > 0.5
    assert np.abs(picture(turns, stretches, True, dicing_rate=0.25) - lit).max() < 1e-3


@pytest.mark.parametrize("light_samples", [4, 64])
def test_samples_that_are_shaded_alone_neither(light_samples):
    """At their own times, which their corners never had."""
    options = {"light_samples": light_samples, "shading_threshold": 0.0}
    lit = picture((-0.15, 0.15), (0.3, 0.7), shadow=False, **options)
    assert np.abs(picture((-0.15, 0.15), (0.3, 0.7), True, **options) - lit).max() < 2e-3
