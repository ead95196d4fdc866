# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways on the picture while the shutter is open: places that a pinhole camera's formula gives."""

import numpy as np
from viewport.motion_paths import TIMES, motion_paths


def at(x, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def snapshot(camera, *things):
    points = np.array([[[-1, -1, 4], [3, 1, 6]]], dtype=np.float32)  # their middle is (1, 0, 5)
    return {
        "camera": {
            "kind": "PERSPECTIVE",
            "world_from_camera": np.array(camera),
            "scale": (100.0, 50.0),
            "center": (32.0, 24.0),
            "clip": (0.1, 100.0),
        },
        "instances": {
            "geometry": np.zeros(len(things), dtype=np.int32),
            "knots": np.array([len(path) for path in things], dtype=np.int32),
            "world_from_object": np.concatenate(things),
        },
        "geometries": [{"points": points}],
    }


def test_a_thing_that_moves_straight_crosses_the_picture_evenly():
    (path,) = motion_paths(snapshot([at(0)], [at(0), at(2, 5)]))
    np.testing.assert_allclose(path[0], (32 + 100 * 1 / 5, 24))
    np.testing.assert_allclose(path[-1], (32 + 100 * 3 / 5, 24 + 50 * 5 / 5))
    np.testing.assert_allclose(np.diff(path, axis=0), np.tile((5, 6.25), (TIMES - 1, 1)))


def test_what_a_zoom_moves_goes_straight_and_evenly():
    zoom = [np.linalg.inv(np.diag([by, by, 1.0, 1.0])) for by in (1.0, 2.0)]
    (path,) = motion_paths(snapshot(zoom, [at(0)]))
    np.testing.assert_allclose(path[:, 0], 32 + 100 / 5 * np.linspace(1.0, 2.0, TIMES))


def test_what_stands_still_is_left_out_unless_the_camera_moves():
    things = [at(0)], [at(0), at(0.001)]
    assert len(motion_paths(snapshot([at(0)], *things))) == 0
    paths = motion_paths(snapshot([at(0), at(1)], *things))
    assert len(paths) == 2
    np.testing.assert_allclose(paths[0][-1] - paths[0][0], (-20, 0))


def test_what_deforms_moves_with_the_middle_of_its_bounds():
    scene = snapshot([at(0)], [at(0)])
    points = scene["geometries"][0]["points"]
    scene["geometries"][0]["points"] = np.concatenate([points, points + (0, 1, 0)])
    (path,) = motion_paths(scene)
    np.testing.assert_allclose(path[-1] - path[0], (0, 10), atol=1e-6)


def test_what_comes_from_behind_the_camera_is_left_out():
    assert len(motion_paths(snapshot([at(0)], [at(0, 0, -9), at(0)]))) == 0
