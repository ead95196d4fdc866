# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of ticks, the ways and the times of what comes and goes, without Blender."""

import numpy as np
import pytest
from export.motion.lifespan import complete, lifespans, runs


def columns(*patterns):
    """bool [T, m] of strings, a character a tick."""
    return np.array([[c == "x" for c in pattern] for pattern in patterns]).T


def ends(found):
    return list(
        zip(*(part.tolist() for part in (found.things, found.numbers, found.first, found.last)))
    )


def test_every_run_has_a_number_the_one_at_the_frame_or_nearest_to_it_its_things():
    seen = columns("xxxxx", "..xxx", "xxx..", "x.x.x", "...xx", "x...x", "xx...")
    things = np.array([1, 3, 4, 6, 7, 8, 11])
    found = runs(things, seen, 2, np.zeros(7, dtype=bool), 20)
    main = [(1, 1, 0, 4), (3, 3, 2, 4), (4, 4, 0, 2), (6, 6, 2, 2), (7, 7, 3, 4), (8, 8, 0, 0)]
    main.append((11, 11, 0, 1))
    assert ends(found) == [*main, (6, 20, 0, 0), (6, 21, 4, 4), (8, 22, 4, 4)]


def test_what_stays_has_one_run():
    found = runs(np.array([5]), columns("x.x.x"), 2, np.array([True]), 20)
    assert ends(found) == [(5, 5, 2, 2)]


def test_nothing_comes_or_goes():
    nothing = np.zeros(0, dtype=int)
    found = runs(nothing, np.zeros((5, 0), dtype=bool), 2, nothing == 0, 20)
    assert ends(found) == []
    times = np.linspace(0, 1, 5)
    spans = lifespans(times, found.first, found.last, np.zeros(0), np.zeros(0))
    assert spans.shape == (0, 2)


def test_ways_go_on_as_they_were_seen():
    """Seen at ticks 4 and 8 at x = 1 and 3; at 8 alone with a velocity; at 8 alone, staying."""
    ticks = [0, 4, 8, 16]
    path = np.tile(np.eye(4), (4, 3, 1, 1))
    path[:, 0, 0, 3] = [-9, 1, 3, -9]
    path[:, 1, 0, 3] = path[:, 2, 0, 3] = [-9, -9, 5, -9]
    path[2, :, 1, 1] = 2.0
    velocity = np.array([(100.0, 0, 0), (0.25, 0, 0), (0.25, 0, 0)])
    first, last = np.array([1, 2, 2]), np.array([2, 2, 2])
    complete(path, ticks, first, last, velocity, np.array([True, True, False]))
    assert path[:, 0, 0, 3].tolist() == [-1, 1, 3, 7]
    assert path[:, 1, 0, 3].tolist() == [3, 4, 5, 7]
    assert path[:, 2, 0, 3].tolist() == [5, 5, 5, 5]
    assert path[:, 0, 1, 1].tolist() == [1, 1, 2, 2] and (path[:, 1, 1, 1] == 2).all()


@pytest.mark.parametrize(
    "birth, death, expected",
    [
        (np.nan, np.nan, (0.125, 0.625)),
        (0.2, 0.55, (0.2, 0.55)),
        (0.25, 0.75, (0.25, 0.75)),  # at the tick itself
        (0.3, 0.9, (0.125, 0.625)),  # which is not what was seen
    ],
)
def test_a_particle_knows_its_times_anything_else_takes_half_way(birth, death, expected):
    times = np.linspace(0, 1, 5)
    found = lifespans(times, np.array([1]), np.array([2]), np.array([birth]), np.array([death]))
    assert found[0] == pytest.approx(expected)


def test_the_ends_of_the_shutter_are_its_ends():
    one = np.array([0.3])
    found = lifespans(np.linspace(0, 1, 5), np.array([0]), np.array([4]), one, one)
    assert found.tolist() == [[0.0, 1.0]]
