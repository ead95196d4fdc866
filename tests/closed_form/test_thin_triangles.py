# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles whose corners lie nearly in a line, as n-gons of buildings and boolean operations leave them."""

import numpy as np
import pytest
import snapshots as s

WIDTH, HEIGHT = 200, 48
LENGTH = 1000.0


@pytest.mark.parametrize("height", [0.0, 1e-3, 0.3, 2.0])
@pytest.mark.parametrize("apex", [0.5, 0.2, 0.03])
def test_micropolygons_follow_the_area(height, apex):
    """And their number the length, not its square: lines from a base to its apex were each as long as the whole."""
    snapshot = s.orthographic((1020, HEIGHT), samples=64)
    corners = [(10, 20, 1), (10 + LENGTH, 20, 1), (10 + apex * LENGTH, 20 + height, 1)]
    s.mesh(snapshot, corners, [(0, 1, 2)], s.emission(snapshot))
    result = s.render(snapshot)
    area = height * LENGTH / 2
    # Of edges that cover a part of each pixel along them.
    noise = np.sqrt(2 * LENGTH / 64)
    assert result["combined"][..., 3].sum() == pytest.approx(area, abs=noise)
    # A side of a tenth is short enough: 16 x 16 micropolygons are a grid, however little they cover.
    assert result["statistics"]["micropolygons"] < 100 * LENGTH + 4 * area


def strips(snapshot, rows, at=lambda x, y: (x, y, 1.0), **more):
    """A rectangle that glows, in rows of a quad each, cut into three triangles from the middle of every second side."""
    points, faces = [], []
    for row in range(rows):
        y0, y1 = HEIGHT * row / rows, HEIGHT * (row + 1) / rows
        first = len(points)
        places = [(5, y0), (WIDTH - 5, y0), (WIDTH - 5, y1), (WIDTH * 0.47, y1), (5, y1)]
        points += [at(*place) for place in places]
        faces += [tuple(first + i for i in face) for face in ((0, 1, 3), (1, 2, 3), (0, 3, 4))]
    s.mesh(snapshot, points, faces, s.emission(snapshot), **more)


@pytest.mark.parametrize("rows", [7, 48, 137])
def test_no_light_passes_between_them(executor, rows):
    snapshot = s.orthographic((WIDTH, HEIGHT), samples=16, executor=executor)
    strips(snapshot, rows)
    assert np.all(s.alpha(snapshot)[:, 6:-6] == 1.0)


def test_nor_where_they_move_and_lie_at_a_slant(executor):
    snapshot = s.perspective((WIDTH, HEIGHT), 100.0, samples=16, executor=executor)
    moves = np.stack([s.translation(-0.4), s.translation(0.4)])

    def floor(x, y):
        return (x - WIDTH / 2) * 0.4, 2.0 + 0.02 * y, 3.0 + y

    strips(snapshot, 90, floor, transforms=moves)
    alpha = s.alpha(snapshot)
    # Rows that the floor fills at all times, from y = 2 at z = 3 to y = 2.96 at z = 51.
    assert np.all(alpha[40:, 20:-20] == 1.0) and alpha[:28].max() == 0.0


def test_a_road_to_the_horizon_takes_no_more_than_its_rectangle(executor):
    """A plump triangle of the picture, however long it is in space."""
    counts = []
    for corners in (
        [(-0.5, 2), (0.5, 2), (0, 2000)],
        [(-0.5, 2), (0.5, 2), (0.5, 2000), (-0.5, 2000)],
    ):
        snapshot = s.perspective((WIDTH, HEIGHT), 100.0, samples=4, executor=executor)
        points = [(x, 0.4, z) for x, z in corners]
        s.mesh(snapshot, points, [tuple(range(len(points)))], s.emission(snapshot))
        counts.append(s.render(snapshot)["statistics"]["micropolygons"])
    assert counts[0] < 1.5 * counts[1]
