# SPDX-License-Identifier: GPL-3.0-or-later
"""Time arithmetic, matching and tables of knots, without Blender."""

import numpy as np
import pytest
from export.instance import knot_table
from export.motion import hold_order, match, split_time


@pytest.mark.parametrize(
    "time, expected",
    [(5.25, (5, 0.25)), (-0.25, (-1, 0.75)), (-3.0, (-3, 0.0)), (0.0, (0, 0.0))],
)
def test_time_splits_by_floor(time, expected):
    assert split_time(time) == expected


def test_a_subframe_that_single_precision_rounds_to_one_is_the_next_frame():
    assert split_time(4.9999999999) == (5, 0.0)


def test_match_by_identity():
    identity = np.array([50, 10, 40], dtype=np.uint64)
    here, there = match(identity, np.argsort(identity), np.array([10, 20, 50, 60], np.uint64))
    assert dict(zip(here.tolist(), there.tolist())) == {1: 0, 0: 2}


def test_match_with_nothing():
    none, some = np.zeros(0, np.uint64), np.array([1], np.uint64)
    for a, b in ((none, some), (some, none)):
        assert [len(x) for x in match(a, np.argsort(a), b)] == [0, 0]


def test_missing_knots_are_held_from_the_frame_outwards():
    assert hold_order(5, 2) == [(3, 2), (4, 3), (1, 2), (0, 1)]
    assert hold_order(3, 0) == [(1, 0), (2, 1)]
    assert hold_order(3, 2) == [(1, 2), (0, 1)]


def test_only_what_moves_has_knots():
    at_frame = np.stack([np.eye(4)] * 3)
    motion = np.stack([at_frame] * 3)
    motion[0, 1, 0, 3] = -2.0
    motion[2, 1, 0, 3] = 2.0
    table, knots = knot_table(at_frame, motion)
    assert knots.tolist() == [1, 3, 1]
    assert table[:, 0, 3].tolist() == [0.0, -2.0, 0.0, 2.0, 0.0]


def test_no_motion_at_all():
    at_frame = np.stack([np.eye(4)] * 2)
    table, knots = knot_table(at_frame, None)
    assert knots.tolist() == [1, 1] and table.shape == (2, 4, 4)
