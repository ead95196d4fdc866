# SPDX-License-Identifier: GPL-3.0-or-later
"""Time arithmetic, matching, paths and their knots, without Blender."""

import numpy as np
import pytest
from export.motion.motion_path import (
    Tracks,
    bends_still,
    body_motions,
    finer_level,
    keep_fewest,
    no_tracks,
    shared_segments,
)
from export.motion.shutter_steps import hold_order, match
from export.scene.shutter import shutter, split_time


@pytest.mark.parametrize(
    "time, expected",
    [(5.25, (5, 0.25)), (-0.25, (-1, 0.75)), (-3.0, (-3, 0.0)), (0.0, (0, 0.0))],
)
def test_time_splits_by_floor(time, expected):
    assert split_time(time) == expected


def test_a_subframe_that_single_precision_rounds_to_one_is_the_next_frame():
    assert split_time(4.9999999999) == (5, 0.0)


@pytest.mark.parametrize(
    "length, position, steps, offsets, frame_tick",
    [
        (0.5, "CENTER", 3, [-0.25, 0.0, 0.25], 1),
        (0.5, "START", 2, [0.0, 0.25, 0.5], 0),
        (1.0, "END", 4, [-1.0, -0.75, -0.5, -0.25, 0.0], 4),
        (0.5, "CENTER", 1, [-0.25], 0),
        (0.0, "CENTER", 9, [0.0], 0),
    ],
)
def test_shutter_ticks(length, position, steps, offsets, frame_tick):
    made = shutter(length, position, steps)
    assert made.frame_tick == frame_tick
    assert [made.offset(tick) for tick in range(made.segments + 1)] == pytest.approx(offsets)


def test_match_by_identity():
    identity = np.array([50, 10, 40], dtype=np.uint64)
    here, there = match(identity, np.argsort(identity), np.array([10, 20, 50, 60], np.uint64))
    assert dict(zip(here.tolist(), there.tolist())) == {1: 0, 0: 2}


def test_match_with_nothing():
    none, some = np.zeros(0, np.uint64), np.array([1], np.uint64)
    for a, b in ((none, some), (some, none)):
        assert [len(x) for x in match(a, np.argsort(a), b)] == [0, 0]


def test_missing_knots_are_held_from_the_frame_outwards():
    assert hold_order([2, 0, 1, 3, 4], 2) == [(3, 2), (4, 3), (1, 2), (0, 1)]
    assert hold_order([0, 8, 4], 0) == [(4, 0), (8, 4)]
    assert hold_order([0, 8, 4], 8) == [(4, 8), (0, 4)]


def test_levels_keep_the_knots_of_those_before():
    assert [finer_level(s, 16) for s in (1, 2, 4, 8, 16)] == [2, 4, 8, 16, None]
    assert [finer_level(s, 6) for s in (1, 2, 6)] == [2, 6, None]
    assert finer_level(1, 2) == 2


def metres(difference):
    return np.abs(difference).max(axis=1)


def test_a_parabola_takes_the_knots_that_its_sagitta_asks_for():
    """x = c t^2 leaves a chord over a part h of the time by c h^2 / 4 at most, in its middle.

    c = 1, .5, 0 pixels with bounds of 1/32: h^2 <= 1/8 and 1/4, so 4, 2 and 1 segments."""
    times = np.arange(17) / 16
    path = {tick: np.array([[c * times[tick] ** 2] for c in (1, 0.5, 0)]) for tick in range(17)}
    assert keep_fewest(path, 16, 16, metres).tolist() == [4, 2, 1]


@pytest.mark.parametrize("strength, still", [(1.9, False), (2.1, True)])
def test_another_level_is_read_where_chords_are_too_long(strength, still):
    """c h^2 / 4 over quarters is 1/32 pixel at c = 2."""
    path = {t: np.array([[strength * (t / 16) ** 2]]) for t in (0, 4, 8, 12, 16)}
    assert bends_still(path, 4, metres) is still


def turn(angle, place=(0.0, 0.0, 0.0)):
    """About z, of what stands at a place."""
    found = np.eye(4)
    found[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    found[:3, 3] = found[:3, :3] @ place
    return found


def test_parts_of_a_body_have_one_motion():
    """In single precision, wherever they stand and lie; what turns on by itself, or has no volume, has another."""
    parts = [
        turn(0.0, (3.0, 1.0, -2.0)),
        turn(1.2, (-50.0, 7.0, 20.0)) * np.float32(0.3),
        np.eye(4),
    ]
    parts[1][3, 3] = 1.0
    first = np.array([*parts, np.zeros((4, 4))])
    last = turn(0.4) @ first
    last[2] = turn(0.45)
    path = {0: first.astype(np.float32).astype(float), 8: last.astype(np.float32).astype(float)}
    found = body_motions(path)
    assert np.abs(found[0] - found[1]).max() <= 1
    assert np.abs(found[0] - found[2]).max() > 100
    assert not found[3].any()


def test_parts_of_one_thing_have_all_their_knots():
    """Those of others stay as they are."""
    segments, groups = np.array([2, 1, 3, 1, 4, 1]), np.array([7, -3, 7, 5, 5, -8])
    assert shared_segments(segments, groups).tolist() == [6, 1, 6, 4, 4, 1]


def test_only_what_moves_has_knots():
    at_frame = np.stack([np.eye(4)] * 3)
    moved = np.stack([at_frame[1:]] * 5)
    moved[:, 0, 0, 3] = [-2, -1, 0, 1, 2]
    moved[:, 1, 0, 3] = [4, 1, 0, 1, 4]
    tracks = Tracks(np.array([1, 2]), moved, np.array([1, 4]))
    table, knots = tracks.table(at_frame, np.array([2, 0, 1]))
    assert knots.tolist() == [5, 1, 2]
    assert table[:, 0, 3].tolist() == [4, 1, 0, 1, 4, 0, -2, 2]


def test_no_motion_at_all():
    at_frame = np.stack([np.eye(4)] * 2)
    table, knots = no_tracks().table(at_frame, np.array([0, 1]))
    assert knots.tolist() == [1, 1] and table.shape == (2, 4, 4)
