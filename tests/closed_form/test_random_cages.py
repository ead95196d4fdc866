# SPDX-License-Identifier: GPL-3.0-or-later
"""Cages by chance: bounds of their patches and of all that these split into hold what is drawn, else a bucket would miss
some of it, and pictures in small buckets and in large ones would differ."""

import numpy as np
import pytest
import snapshots as s

SIZE = (96, 96)


def prism(random):
    """An n-gon, and the quads down to another: corners of three faces, and irregular faces."""
    n = random.integers(3, 9)
    angle = np.arange(n) * 2 * np.pi / n
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(n)], 1)
    around = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    ends = [tuple(range(n))[::-1], tuple(range(n, 2 * n))]
    return np.concatenate([ring, ring + [0, 0, 1]]), around + ends


def fan(random):
    """Triangles about one vertex, which has that many edges; a border."""
    n = random.integers(3, 12)
    angle = np.arange(n) * 2 * np.pi / n
    ring = np.stack([np.cos(angle), np.sin(angle), random.uniform(-1, 1, n)], 1)
    return np.concatenate([ring, [[0, 0, 1]]]), [(i, (i + 1) % n, n) for i in range(n)]


def sheet(random):
    """Quads with a triangle or a hole here and there, and vertices anywhere: folded, some through themselves."""
    side = random.integers(2, 5)
    u, v = np.meshgrid(np.linspace(-1, 1, side + 1), np.linspace(-1, 1, side + 1))
    points = np.stack([u.ravel(), v.ravel(), random.uniform(-0.5, 0.5, u.size)], 1)
    points[:, :2] += random.normal(0, 0.4 / side, (len(points), 2))
    faces = []
    for first in (np.arange(side) + (side + 1) * np.arange(side)[:, None]).ravel():
        quad = (first, first + 1, first + side + 2, first + side + 1)
        kind = random.random()
        if kind > 0.1:
            faces += [quad] if kind > 0.3 else [quad[:3], (quad[0], *quad[2:])]
    return points, faces or [(0, 1, side + 1)]


def cage(random):
    points, faces = (prism, fan, sheet)[random.integers(3)](random)
    points = points * random.uniform(10, 35, 3) + random.normal(0, 3, points.shape)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    points = points @ turn + [SIZE[0] / 2, SIZE[1] / 2, 200]
    edges = sorted({tuple(sorted(e)) for f in faces for e in zip(f, (*f[1:], f[0]))})
    creased = [edge for edge in edges if random.random() < 0.4]
    sharpness = random.choice([0.3, 0.9, 1.5, 2.7, 10.0], len(creased))
    corners = np.where(random.random(len(points)) < 0.3, random.uniform(0, 4, len(points)), 0)
    subdivision = {
        "scheme": "CATMULL_CLARK",
        "boundary": ("ALL", "PRESERVE_CORNERS")[random.integers(2)],
        "crease_verts": np.int32(creased).reshape(-1, 2),
        "crease_values": np.float32(sharpness),
        "vertex_creases": np.float32(corners),
    }
    return points, faces, subdivision


def picture(seed, bucket_size):
    random = np.random.default_rng(seed)
    snapshot = s.orthographic(SIZE, samples=4, bucket_size=bucket_size)
    points, faces, subdivision = cage(random)
    paint = s.emission(snapshot, (1, 0.5, 0.25))
    s.mesh(snapshot, points, faces, paint, subdivision=subdivision)
    return s.render(snapshot)["combined"]


@pytest.mark.parametrize("seed", range(0, 200, 25))
def test_bounds_hold_what_they_are_of(seed):
    drawn = 0
    for one in range(seed, seed + 25):
        small = picture(one, 16)
        np.testing.assert_array_equal(small, picture(one, 128), err_msg=str(one))
        drawn += small[..., 3].sum() > 50
    assert drawn > 20
