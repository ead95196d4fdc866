# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of the icosahedron and of the dodecahedron, of triangles and of pentagons: convex, so that nothing of them
shades another part of it, and closed, so that no light comes through."""

import itertools

import numpy as np
import pytest
import snapshots as s

CASTS_SHADOW, CAMERA, BOTH = 2, 1, 3
SIZE = 64
MIDDLE = np.array([SIZE / 2, SIZE / 2, 40.0])


def icosahedron():
    golden = (1 + 5**0.5) / 2
    points = np.array(
        [
            np.roll((0.0, a, b * golden), k)
            for k in range(3)
            for a, b in itertools.product((1, -1), (1, -1))
        ]
    )
    faces = []
    for a, b, c in itertools.combinations(range(12), 3):
        p, q, r = points[[a, b, c]]
        if max(np.linalg.norm(d) for d in (p - q, q - r, r - p)) < 2.01:
            faces.append((a, b, c) if np.dot(np.cross(q - p, r - p), p) > 0 else (a, c, b))
    return points, faces


def dodecahedron():
    """The icosahedron's dual."""
    corners, triangles = icosahedron()
    points, faces = np.array([corners[list(t)].mean(0) for t in triangles]), []
    for number, axis in enumerate(corners):
        around = [i for i, t in enumerate(triangles) if number in t]
        u = points[around[0]] - axis * np.dot(points[around[0]], axis) / np.dot(axis, axis)
        v = np.cross(axis, u) / np.linalg.norm(axis)
        faces.append(tuple(sorted(around, key=lambda i: np.arctan2(points[i] @ v, points[i] @ u))))
    return points, faces


def light(cage, knots, flags, floor=None):
    """Of a sun behind the camera, [SIZE, SIZE]; the body grows by a fifth at the middle of three knots."""
    points, faces = cage()
    points = points / np.linalg.norm(points, axis=1).max() * 24.0
    scales = (1.0,) if knots == 1 else (1.0, 1.2, 1.0)
    snapshot = s.orthographic((SIZE, SIZE), samples=16, executor="SIMD", light_samples=16)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    s.mesh(
        snapshot,
        np.stack([points * k + MIDDLE for k in scales]),
        faces,
        0,
        subdivision={"scheme": "CATMULL_CLARK"},
        smooth=np.ones(len(faces), np.uint8),
    )
    snapshot["instances"]["flags"] = [flags]
    if floor is not None:
        s.quad(snapshot, s.rectangle(-50, -50, 120, 120, 90.0), 0)
        snapshot["instances"]["flags"].append(floor)
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": 3.0}
    snapshot["lights"] = [{**sun, "sun_angle": 0.0}]
    return s.render(snapshot)["combined"][..., 0]


@pytest.mark.parametrize("knots", [1, 3], ids=["still", "deforming"])
@pytest.mark.parametrize("cage", [icosahedron, dodecahedron])
def test_a_convex_limit_does_not_shade_itself(cage, knots):
    unshaded = light(cage, knots, CAMERA)
    assert unshaded.max() > 0.7  # towards the sun: .8 times 3 / pi
    # At its rim points lie densely, where a few of the shutter's times light each: off by .000008.
    assert light(cage, knots, BOTH) == pytest.approx(unshaded, abs=1e-6 if knots == 1 else 2e-5)


@pytest.mark.parametrize("knots", [1, 3], ids=["still", "deforming"])
@pytest.mark.parametrize("cage", [icosahedron, dodecahedron])
def test_a_closed_limit_lets_no_light_through(cage, knots):
    floor = light(cage, knots, CASTS_SHADOW, floor=CAMERA)
    away = np.hypot(*(np.mgrid[:SIZE, :SIZE] + 0.5 - SIZE / 2))
    # The limit of an icosahedron of radius 24 is wider than 12 and no wider than the cage, 29 where it has grown.
    assert floor[away < 12].max() == 0.0
    assert floor[away > 30] == pytest.approx(0.8 * 3.0 / np.pi, rel=1e-5)
