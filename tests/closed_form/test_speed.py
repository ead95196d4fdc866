# SPDX-License-Identifier: GPL-3.0-or-later
"""The pass Vector against closed forms: pixels from the place one frame before, and to the one after."""

import numpy as np
import pytest
import snapshots

# float32 of places of some 20 pixels, and their filtered sums.
ROUNDING = 1e-4


def speed(snapshot):
    snapshot["options"]["passes"] = ["Vector"]
    return snapshots.render(snapshot)["passes"]["Vector"]


def wall(snapshot, z=4.0, **extra):
    snapshots.quad(snapshot, snapshots.rectangle(-99, -99, 99, 99, z), **extra)


def pair(before, after):
    return np.array([before, after], float)


def test_what_stands_has_none(executor):
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    wall(snapshot)
    assert np.abs(speed(snapshot)).max() == 0.0


def test_a_place(executor):
    """It comes from 3 pixels to the left and goes 5 up: (before - now, now - after)."""
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    wall(snapshot)
    snapshot["instances"]["adjacent"] = pair(
        snapshots.translation(-3, 0), snapshots.translation(0, 5)
    )
    assert np.abs(speed(snapshot) - (-3, 0, 0, -5)).max() < ROUNDING


def test_edges_are_no_mixture_with_nothing(executor):
    """Half a pixel of coverage: still the surface's own."""
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    snapshots.quad(snapshot, snapshots.rectangle(0, 0, 4.5, 8))
    snapshot["instances"]["adjacent"] = pair(
        snapshots.translation(-3, 0), snapshots.translation(0, 5)
    )
    made = speed(snapshot)
    assert np.abs(made[:, :5] - (-3, 0, 0, -5)).max() < ROUNDING
    assert np.all(made[:, 5:] == 0.0)


def test_a_shape(executor):
    """The right end is pulled out by 8 pixels of 16 in a frame: x goes to 1.5 x."""
    snapshot = snapshots.orthographic((16, 8), executor=executor, samples=64)
    now = np.float32(snapshots.rectangle(0, 0, 16, 8, 4.0))
    wider = now * np.float32([1.5, 1, 1])
    snapshots.quad(snapshot, now, adjacent=np.stack([now, wider]))
    made = speed(snapshot)
    assert np.all(made[..., [0, 1, 3]] == 0.0)
    # A pixel's 64 stratified samples lie within .2 pixels about its centre in the mean.
    assert made[..., 2] == pytest.approx(np.tile(-0.5 * (np.arange(16) + 0.5), (8, 1)), abs=0.1)


def test_a_subdivided_shape_is_that_of_its_limit(executor):
    """A cage that is doubled has a limit that is doubled; of a cube's, no point is a cage's point."""
    snapshot = snapshots.perspective((32, 32), 64.0, executor=executor, samples=16)
    cube = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    place = snapshots.translation(0, 0, 6)
    snapshots.mesh(
        snapshot, cube, faces, transforms=[place],
        subdivision={"scheme": "CATMULL_CLARK", "boundary": "ALL"},
        adjacent=np.stack([2 * cube, cube]),
    )  # fmt: skip
    snapshot["options"]["passes"] = ["Vector", "Position"]
    passes = snapshots.render(snapshot)["passes"]
    made, p = passes["Vector"], passes["Position"]
    seen = p[..., 2] > 0.0
    # Doubled about (0, 0, 6): z' = 6 + 2 (z - 6).
    p[~seen] = (0, 0, 4)
    twice = 2.0 * p - (0, 0, 6)
    expected = 64.0 * (twice[..., :2] / twice[..., 2:] - p[..., :2] / p[..., 2:])
    # The pass is of 16 samples, the position of one: half a pixel of 12 apart.
    inner = (
        seen
        & np.roll(seen, 2, 0)
        & np.roll(seen, -2, 0)
        & np.roll(seen, 2, 1)
        & np.roll(seen, -2, 1)
    )
    assert inner.sum() > 100 and np.abs(expected[inner]).max() > 4.0
    assert np.abs(made[inner][:, :2] - expected[inner]).max() < 0.6
    assert np.abs((made[inner][:, :2] - expected[inner]).mean(axis=0)).max() < 0.05
    assert np.all(made[..., 2:] == 0.0)


def test_a_camera(executor):
    """It moves 1 m to the right a frame and one back: f X / z moves by f / z."""
    snapshot = snapshots.perspective((16, 16), 20.0, executor=executor)
    wall(snapshot, 5.0)
    snapshot["camera"]["adjacent"] = pair(snapshots.translation(-1), snapshots.translation(1))
    assert np.abs(speed(snapshot) - (4, 0, 4, 0)).max() < ROUNDING


def test_what_was_behind_the_camera_has_none(executor):
    snapshot = snapshots.perspective((8, 8), 20.0, executor=executor)
    wall(snapshot, 5.0)
    snapshot["instances"]["adjacent"] = pair(
        snapshots.translation(0, 0, -6), snapshots.translation(1, 0, 0)
    )
    assert np.abs(speed(snapshot) - (0, 0, -4, 0)).max() < ROUNDING


def test_it_is_of_whole_frames_in_a_blurred_picture_too(executor):
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    wall(snapshot, transforms=[snapshots.translation(-1), snapshots.translation(1)])
    snapshot["instances"]["adjacent"] = pair(snapshots.translation(-4), snapshots.translation(4))
    assert np.abs(speed(snapshot) - (-4, 0, -4, 0)).max() < ROUNDING


def test_hair_and_points(executor):
    """A bundle of vertical hair that covers the frame, pushed to the right."""
    snapshot = snapshots.orthographic((8, 8), executor=executor)
    points = np.array([(x, y, 4) for x in range(9) for y in (-2, 3, 5, 10)], np.float32)
    snapshot["geometries"].append(
        {
            "name": "curves", "kind": "CURVES", "points": points[None],
            "curve_sizes": np.full(9, 4, np.int32), "radius": np.ones((1, 36), np.float32),
            "adjacent": np.stack([points, points + np.float32([2, 0, 0])]),
        }
    )  # fmt: skip
    snapshots.instance(snapshot, 0)
    assert np.abs(speed(snapshot) - (0, 0, -2, 0)).max() < ROUNDING


@pytest.mark.parametrize("key", ["instances", "camera", "geometry"])
def test_wrong_sizes_are_refused_by_name(key):
    import granita_core

    snapshot = snapshots.orthographic((8, 8))
    wall(snapshot)
    owner = snapshot["geometries"][0] if key == "geometry" else snapshot[key]
    owner["adjacent"] = np.zeros((1, 4, 3), np.float32) if key == "geometry" else np.eye(4)[None]
    with pytest.raises(granita_core.SceneError, match="adjacent"):
        speed(snapshot)
