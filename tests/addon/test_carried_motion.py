# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion carried over to a later reading: straight paths, of which every place is known."""

import numpy as np
import pytest
from export.base.snapshot import Places
from viewport.carried_motion import ShutterTimes, carried, corrected


def at(x, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def turned(angle, x=0.0):
    matrix = at(x)
    c, s = np.cos(angle), np.sin(angle)
    matrix[:2, :2] = [[c, -s], [s, c]]
    return matrix


def snapshot(camera, places, points=None, **lens):
    places = np.array(places)
    return {
        "camera": {
            "world_from_camera": np.array(camera),
            "lens_radius": 0.1,
            "focus_distance": 5.0,
            **lens,
        },
        "instances": {
            "name": ["A"],
            "key": np.array([7], dtype=np.uint32),
            "knots": np.array([len(places)], dtype=np.int32),
            "world_from_object": places,
        },
        "geometries": [
            {"points": np.zeros((1, 1, 3), dtype=np.float32) if points is None else points}
        ],
        "lights": [],
    }


HALF = ShutterTimes(0.5, 0.5)
MOVING = snapshot([at(0, -1), at(0, 1)], [at(1), at(2), at(3)])


def zoomed(by):
    return np.linalg.inv(np.diag([by, by, 1.0, 1.0]))


def test_a_camera_that_zooms_goes_on_as_it_did():
    """From twice to four times; the shutter of the new picture is half as long, and begins where the zoom is 2.5."""
    moving = snapshot([zoomed(2.0), zoomed(4.0)], [at(0)])
    still = snapshot([zoomed(3.0)], [at(0)])
    short = ShutterTimes(0.25, 0.5)
    found = carried(still, short, moving, HALF)["camera"]["world_from_camera"]
    np.testing.assert_allclose(found, [zoomed(2.5), zoomed(3.5)])


def test_what_did_not_change_keeps_its_very_knots():
    still = snapshot([at(0)], [at(2)])
    found = carried(still, HALF, MOVING, HALF)
    assert found["instances"]["world_from_object"] is not still["instances"]["world_from_object"]
    np.testing.assert_array_equal(
        found["instances"]["world_from_object"], MOVING["instances"]["world_from_object"]
    )
    np.testing.assert_array_equal(
        found["camera"]["world_from_camera"], MOVING["camera"]["world_from_camera"]
    )


def test_what_was_moved_and_turned_goes_on_in_the_same_direction():
    found = carried(snapshot([at(0)], [turned(0.3, 10)]), HALF, MOVING, HALF)
    np.testing.assert_allclose(
        found["instances"]["world_from_object"], [turned(0.3, 9), turned(0.3, 10), turned(0.3, 11)]
    )


@pytest.mark.parametrize(
    "times, ends", [(ShutterTimes(1.0, 0.5), (0, 4)), (ShutterTimes(0.5, 0.0), (2, 4))]
)
def test_a_longer_or_later_shutter_sees_more_of_the_path(times, ends):
    """The path is x = 2 + 4 t for t frames after the frame."""
    found = carried(snapshot([at(0)], [at(2)]), times, MOVING, HALF)
    x = found["instances"]["world_from_object"][:, 0, 3]
    np.testing.assert_allclose(x, np.linspace(*ends, 3), atol=1e-12)


def test_deformation_goes_on_from_the_shape_that_is_there():
    then = np.array([[[0, 0, 0]], [[0, 0, 2]]], dtype=np.float32)
    now = np.array([[[5, 0, 1]]], dtype=np.float32)
    moving = snapshot([at(0)], [at(0)], points=then)
    found = carried(snapshot([at(0)], [at(0)], points=now), HALF, moving, HALF)
    np.testing.assert_allclose(found["geometries"][0]["points"], [[[5, 0, 0]], [[5, 0, 2]]])


def test_a_lens_that_changes_is_as_much_wider():
    moving = snapshot([at(0)], [at(0)], lens_knots=np.array([[0.1, 4.0], [0.1, 6.0]]))
    still = snapshot([at(0)], [at(0)], lens_radius=0.2)
    found = carried(still, HALF, moving, HALF)
    np.testing.assert_allclose(found["camera"]["lens_knots"], [[0.2, 4.0], [0.2, 6.0]])


HERE = Places(at(0), np.array([at(2)]), [])


def test_a_path_that_is_bent_a_little_is_no_move_of_the_artist_s():
    """Its knots are straight between; what is keyed is there at the frame all the same."""
    still = snapshot([at(0.001)], [at(2.002)])
    found = corrected(MOVING, HALF, Places(at(0.001), np.array([at(2.002)]), []), still)
    assert found["instances"] is MOVING["instances"] and found["camera"] is MOVING["camera"]


def test_what_agrees_at_the_frame_is_the_reading_of_the_shutter_itself():
    still = snapshot([at(1e-7)], [at(2 + 1e-7)])
    found = corrected(MOVING, HALF, HERE, still)
    assert found["instances"] is MOVING["instances"] and found["camera"] is MOVING["camera"]


def test_what_was_moved_without_a_key_moves_from_where_it_is():
    still = snapshot([at(0, 0, 3)], [at(2, 5)])
    found = corrected(MOVING, HALF, HERE, still)
    places = found["instances"]["world_from_object"]
    np.testing.assert_allclose(places, [at(1, 5), at(2, 5), at(3, 5)])
    np.testing.assert_allclose(found["camera"]["world_from_camera"], [at(0, -1, 3), at(0, 1, 3)])
    assert MOVING["instances"]["world_from_object"][0, 1, 3] == 0.0


def test_others_than_before_stand_still():
    still = snapshot([at(0)], [at(2)])
    still["instances"]["name"] = ["B"]
    assert carried(still, HALF, MOVING, HALF)["instances"] is still["instances"]
