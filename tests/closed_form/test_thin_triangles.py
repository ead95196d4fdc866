# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles whose corners lie nearly in a line, as n-gons of buildings and boolean operations leave them."""

import numpy as np
import pytest
import snapshots as s
from session_parts import DOWN, matte, sun

WIDTH, HEIGHT = 200, 48
LENGTH = 1000.0


@pytest.mark.parametrize("height", [0.0, 1e-3, 0.3, 2.0])
@pytest.mark.parametrize("apex", [0.5, 0.2, 0.03])
def test_micropolygons_follow_the_area(height, apex):
    """Some along each side, and no more: lines from a side to its apex were each as long as the whole."""
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


def strips(snapshot, rows, surface, at=lambda x, y: (x, y, 1.0), **more):
    """A rectangle in rows of a quad each, cut into three triangles from the middle of every second side."""
    points, faces = [], []
    for row in range(rows):
        y0, y1 = HEIGHT * row / rows, HEIGHT * (row + 1) / rows
        first = len(points)
        places = [(5, y0), (WIDTH - 5, y0), (WIDTH - 5, y1), (WIDTH * 0.47, y1), (5, y1)]
        points += [at(*place) for place in places]
        faces += [tuple(first + i for i in face) for face in ((0, 1, 3), (1, 2, 3), (0, 3, 4))]
    s.mesh(snapshot, points, faces, surface, **more)


@pytest.mark.parametrize("rows", [7, 48, 137])
def test_no_light_passes_between_them(executor, rows):
    snapshot = s.orthographic((WIDTH, HEIGHT), samples=16, executor=executor)
    strips(snapshot, rows, s.emission(snapshot))
    assert np.all(s.alpha(snapshot)[:, 6:-6] == 1.0)


def test_nor_where_they_move_and_lie_at_a_slant(executor):
    snapshot = s.perspective((WIDTH, HEIGHT), 100.0, samples=16, executor=executor)
    moves = np.stack([s.translation(-0.4), s.translation(0.4)])

    def floor(x, y):
        return (x - WIDTH / 2) * 0.4, 2.0 + 0.02 * y, 3.0 + y

    strips(snapshot, 90, s.emission(snapshot), floor, transforms=moves)
    alpha = s.alpha(snapshot)
    # Rows that the floor fills at all times, from y = 2 at z = 3 to y = 2.96 at z = 51.
    assert np.all(alpha[40:, 20:-20] == 1.0) and alpha[:28].max() == 0.0


def test_light_samples_follow_the_area():
    """Strips of a tenth of a pixel under a wide sun: a point of each took those of a whole pixel."""
    snapshot = s.orthographic((WIDTH, HEIGHT), samples=16, light_samples=16)
    sun(snapshot, DOWN, sun_angle=0.5)
    strips(snapshot, 10 * HEIGHT, matte(snapshot, (0.8, 0.8, 0.8)))
    result = s.render(snapshot)
    # What faces a sun has its irradiance, however wide it is.
    seen = result["combined"][2:-2, 8:-8, 0]
    assert seen.mean() == pytest.approx(0.8 / np.pi * 3.0, rel=1e-3)
    assert result["statistics"]["rays_shadow"] < 450 * WIDTH * HEIGHT


def test_what_lies_far_away_in_one_direction_takes_no_more(executor):
    """A face that runs to the horizon, nearly along the view: samples of its near end alone see it."""
    snapshot = s.perspective((32, 24), 30.0, samples=4, executor=executor)
    points = [(-0.2, 0.1, 4.0), (0.2, 0.1, 4.0), (0.2, 0.1, 1e12), (-0.2, 0.1, 1e12)]
    s.mesh(snapshot, points, [(0, 1, 2, 3)], s.emission(snapshot))
    result = s.render(snapshot)
    assert result["combined"][..., 3].sum() == pytest.approx(0.5 * 3.0 * 0.75, rel=0.25)
    assert result["statistics"]["micropolygons"] < 20_000
