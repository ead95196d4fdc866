# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves, hair and points in motion and in their extremes, through Blender's render, against closed forms
(film_parts): cases 27 and 57."""

import numpy as np
from film_parts import HEIGHT, MIDPOINTS, WIDTH, alpha, hold, left_of, moving_disc, over_time
from hair_parts import curve_through, furry, mesh_points
from motion_parts import drive


def test_a_point_that_moves_is_a_moving_disc(film, render):
    """Cases 13 and 27."""
    drive(mesh_points(film, [(6.0, 8.0, 0.0)], [], 5.0), "location", "20 * (frame - 10)", 0)
    hold(alpha(render, film), moving_disc((6.0, 8.0), 5.0, 20.0), crossings=2)


def test_a_curve_that_moves_is_a_moving_strip(film, render):
    """Case 27."""
    curve = curve_through(film, [(6.0, -20.0, 0.0), (6.0, 8.0, 0.0), (6.0, 40.0, 0.0)], 2.0)
    drive(curve, "location", "20 * (frame - 10)", 0)
    pixels = np.arange(WIDTH)
    expected = over_time(
        lambda t: left_of(8 + 20 * t, pixels) - left_of(4 + 20 * t, pixels), MIDPOINTS
    )
    hold(alpha(render, film), np.broadcast_to(expected, (HEIGHT, WIDTH)), crossings=2)


def test_what_has_no_width_is_not_there(film, render):
    """Case 57: a curve, a point and hair."""
    curve_through(film, [(6.0, 4.0, 0.0), (26.0, 12.0, 0.0)], 0.0)
    mesh_points(film, [(6.0, 8.0, 0.0)], [], 0.0)
    hair = furry(film, hair_length=5.0, root_radius=0.0, tip_radius=0.0)
    hair.show_instancer_for_render = False
    for thing in film.objects:
        if thing != film.camera:
            drive(thing, "location", "20 * (frame - 10)", 0)
    assert not alpha(render, film).any()


def test_a_cusp_covers_what_the_way_there_covers(film, render):
    """Case 57: out and back by the same way."""
    curve_through(film, [(6.0, 8.0, 0.0), (26.0, 8.0, 0.0), (6.0, 8.0, 0.0)], 4.0)
    expected = np.zeros((HEIGHT, WIDTH))
    expected[4:12, 6:26] = 1.0
    assert np.array_equal(alpha(render, film), expected)


def test_the_camera_inside_of_a_curve(film, render):
    """Case 57: a ribbon of 30 metres, half a metre before the camera, and one behind it."""
    film.camera.data.type = "PERSP"
    for z in (49.5, 50.5):
        curve_through(film, [(-200.0, 8.0, z), (16.0, 8.0, z), (200.0, 8.0, z)], 15.0)
    assert (alpha(render, film) == 1.0).all()
