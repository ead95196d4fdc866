# SPDX-License-Identifier: GPL-3.0-or-later
"""Pointiness of shapes whose angles are known."""

import numpy as np
import pytest
from export.geometry.pointiness import pointiness

CORNERS = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
SIDES = np.array(
    [(a, b) for a in range(8) for b in range(a) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 2],
    np.int32,
)
OUTWARDS = CORNERS / np.float32(np.sqrt(3.0))
# Three sides at right angles: their mean leans by this much from the way out.
OF_A_CUBE = np.arccos(-1.0 / np.sqrt(3.0)) / np.pi


def test_corners_of_a_cube():
    assert pointiness(CORNERS, OUTWARDS, SIDES) == pytest.approx(np.full(8, OF_A_CUBE), abs=1e-6)


def test_dents_are_the_other_way():
    dents = pointiness(CORNERS, -OUTWARDS, SIDES)
    assert dents == pytest.approx(np.full(8, 1.0 - OF_A_CUBE), abs=1e-6)


def test_what_is_flat_is_in_the_middle():
    places = np.array([(x, y, 0) for y in range(4) for x in range(4)], np.float32)
    edges = [(i, i + 1) for i in range(16) if i % 4 < 3] + [(i, i + 4) for i in range(12)]
    up = np.tile(np.float32([0, 0, 1]), (16, 1))
    assert pointiness(places, up, np.array(edges, np.int32)) == pytest.approx(np.full(16, 0.5))


def test_vertices_at_one_place_are_one():
    """A cube that is split along its edges: each corner three times, each side twice."""
    faces = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    corners = np.array(faces).ravel()
    normals = np.zeros((24, 3), np.float32)
    for face in range(6):
        middle = CORNERS[list(faces[face])].mean(axis=0)
        normals[4 * face : 4 * face + 4] = middle
    edges = [(4 * f + k, 4 * f + (k + 1) % 4) for f in range(6) for k in range(4)]
    split = pointiness(CORNERS[corners], normals, np.array(edges, np.int32))
    assert split == pytest.approx(np.full(24, OF_A_CUBE), abs=1e-6)


def test_the_neighbours_take_part():
    """The end of a spike, of which the other end lies in no ridge."""
    places = np.array([(0, 0, 1), (0, 0, 0)], np.float32)
    normals = np.array([(0, 0, 1), (1, 0, 0)], np.float32)
    assert pointiness(places, normals, np.array([(0, 1)], np.int32)).tolist() == [0.75, 0.75]


def test_a_vertex_without_edges():
    alone = pointiness(np.zeros((1, 3), np.float32), OUTWARDS[:1], np.zeros((0, 2), np.int32))
    assert alone.tolist() == [0.0]
