# SPDX-License-Identifier: GPL-3.0-or-later
"""A shutter's snapshot at one time: each path at that time, and nothing else changed."""

import numpy as np
from viewport.one_time import at_time


def at(x):
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def zoomed(by):
    """A camera that looks along z, whose picture is `by` times as large."""
    return np.linalg.inv(np.diag([by, by, 1.0, 1.0]))


def test_a_zoom_shows_what_the_picture_of_the_whole_shutter_shows_then():
    """What is seen goes straight on the picture: twice as far from its middle, then three times in the middle of the way."""
    scene = snapshot()
    scene["camera"]["world_from_camera"] = np.array([zoomed(2.0), zoomed(4.0)])
    (camera,) = at_time(scene, 0.5)["camera"]["world_from_camera"]
    np.testing.assert_allclose(np.linalg.inv(camera), np.diag([3.0, 3.0, 1.0, 1.0]))


def snapshot():
    points = np.zeros((3, 2, 3), dtype=np.float32)
    points[:, 0, 2] = 0, 4, 8
    return {
        "options": {"samples": 4, "rolling_shutter": 0.5},
        "camera": {
            "world_from_camera": np.array([at(0), at(8)]),
            "lens_knots": np.array([[0.2, 4.0], [0.4, 8.0]]),
            "lens_radius": 0.3,
            "focus_distance": 6.0,
        },
        "instances": {
            "name": ["Still", "Moving", "Brief"],
            "knots": np.array([1, 3, 2], dtype=np.int32),
            "world_from_object": np.array([at(7), at(0), at(1), at(3), at(5), at(6)]),
            "lifespan": np.array([[0, 1], [0, 1], [0.5, 1]], dtype=np.float32),
        },
        "geometries": [
            {"points": points, "radius": np.array([[1.0], [2.0], [4.0]], dtype=np.float32)},
            {"points": points[:1]},
        ],
        "lights": [
            {
                "name": "Lamp",
                "world_from_light": np.array([at(0), at(2)]),
                "energy": 5.0,
                "energy_knots": np.array([10.0, 20.0], dtype=np.float32),
            },
            {
                "name": "Flash",
                "world_from_light": np.array([at(0)]),
                "energy": 1.0,
                "lifespan": np.array([0.5, 1.0], dtype=np.float32),
            },
        ],
    }


def test_all_is_where_it_is_at_that_time():
    whole = snapshot()
    found = at_time(whole, 0.25)
    camera, instances = found["camera"], found["instances"]
    np.testing.assert_allclose(camera["world_from_camera"], [at(2)])
    np.testing.assert_allclose([camera["lens_radius"], camera["focus_distance"]], [0.25, 5.0])
    assert "lens_knots" not in camera
    np.testing.assert_array_equal(instances["knots"], (1, 1, 1))
    np.testing.assert_allclose(instances["world_from_object"][:2], [at(7), at(0.5)])
    assert (instances["world_from_object"][2, :3, :3] == 0).all()  # not there yet
    assert "lifespan" not in instances
    assert found["geometries"][0]["points"].dtype == np.float32
    np.testing.assert_allclose(found["geometries"][0]["points"][:, 0, 2], [2])
    np.testing.assert_allclose(found["geometries"][0]["radius"], [[1.5]])
    assert found["geometries"][1] is whole["geometries"][1]
    (lamp,) = found["lights"]
    np.testing.assert_allclose(lamp["world_from_light"], [at(0.5)])
    assert lamp["energy"] == 12.5 and "energy_knots" not in lamp
    assert found["options"]["rolling_shutter"] == -1.0
    assert whole["camera"]["lens_radius"] == 0.3 and len(whole["lights"]) == 2


def test_what_comes_later_is_there_then():
    found = at_time(snapshot(), 0.75)
    np.testing.assert_allclose(found["instances"]["world_from_object"][2], at(5.75))
    assert [light["name"] for light in found["lights"]] == ["Lamp", "Flash"]
