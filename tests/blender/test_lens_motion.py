# SPDX-License-Identifier: GPL-3.0-or-later
"""Focus and f-stop that change within the shutter, through Blender's render, against closed forms.

A defocused half plane covers of a place the part of its circle of confusion that lies left of the
edge; over the shutter that is averaged.  Cycles takes focus and f-stop at the frame, so it is no
witness here.
"""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from film_parts import HEIGHT, WIDTH, alpha, wall
from motion_parts import drive

TIMES = (np.arange(512) + 0.5) / 512


@pytest.fixture
def lens(film):
    """The lens of a camera 50 m before the walls; orthographic, its radius is 1 / (2 N) metres."""
    dof = film.camera.data.dof
    dof.use_dof = True
    dof.focus_distance = 100.0
    dof.aperture_fstop = 0.1
    film.granita.motion_steps = 65
    return dof


def blurred_edge(edge, radii):
    fine = 8
    x = edge - (np.arange(WIDTH * fine) + 0.5) / fine
    d = np.clip(x[None] / np.maximum(radii, 1e-9)[:, None], -1, 1)
    share = 0.5 + (d * np.sqrt(1 - d**2) + np.arcsin(d)) / np.pi
    return share.mean(axis=0).reshape(WIDTH, fine).mean(axis=1)


def hold(image, radii, edge=WIDTH / 2):
    """Four standard errors of independent samples, an upper bound; for the mean over rows, whose
    samples are stratified together, half as much as its own."""
    expected = blurred_edge(edge, radii)
    deviation = np.sqrt(np.maximum(expected * (1 - expected), 1e-6) / 256)
    assert (np.abs(image - expected) <= 4 * deviation + 1 / 256).all()
    assert (np.abs(image.mean(axis=0) - expected) <= 2 * deviation / np.sqrt(HEIGHT) + 1e-3).all()


@pytest.mark.smoke
def test_the_focus_distance_changes(film, lens, render):
    wall(film, WIDTH / 2)
    drive(lens, "focus_distance", "25 + 75 * (frame - 10)")
    hold(alpha(render, film), 5 * np.abs(50 / (25 + 75 * TIMES) - 1))


def test_the_focus_object_moves(film, lens, render):
    wall(film, WIDTH / 2)
    lens.focus_object = scene_parts.add_object(film, "Target", None, (3, 4, 0))
    drive(lens.focus_object, "location", "25 - 75 * (frame - 10)", 2)
    hold(alpha(render, film), 5 * np.abs(50 / (25 + 75 * TIMES) - 1))


def test_the_camera_comes_nearer_to_its_focus_object(film, lens, render):
    """Both are straight in time: the focus from 100 m to 60 m, the wall from 50 m to 10 m."""
    wall(film, WIDTH / 2)
    lens.focus_object = scene_parts.add_object(film, "Target", None, (0, 0, -50))
    drive(film.camera, "location", "50 - 40 * (frame - 10)", 2)
    distance = 50 - 40 * TIMES
    hold(alpha(render, film), 5 * np.abs(distance / (distance + 50) - 1))


def test_the_f_stop_changes(film, lens, render):
    """N = 1 / (4 + 12 t): the radius 2 + 6 t is straight and two knots hold it."""
    wall(film, WIDTH / 2)
    drive(lens, "aperture_fstop", "1 / (4 + 12 * (frame - 10))")
    hold(alpha(render, film), (2 + 6 * TIMES) * 0.5)


def test_an_f_stop_whose_radius_bends(film, lens, render):
    """N = 1/16 + 3/16 t: a hyperbola."""
    wall(film, WIDTH / 2)
    drive(lens, "aperture_fstop", "(1 + 3 * (frame - 10)) / 16")
    hold(alpha(render, film), 8 / (1 + 3 * TIMES) * 0.5)


def test_a_focal_length_changes_the_lens_too(film, lens, render):
    """At one f-stop a lens twice as long is twice as wide, and its picture twice as large: circles of
    L (L / 1000 / 2 N) |1 / F - 1 / z| pixels, L millimetres and pixels."""
    camera = film.camera
    camera.data.type, camera.data.sensor_width = "PERSP", 32.0
    camera.location.z = 10.0
    lens.focus_distance = 1.0
    wall(film, WIDTH / 2)
    drive(camera.data, "lens", "20 + 20 * (frame - 10)")
    length = 20 + 20 * TIMES
    hold(alpha(render, film), length * length / 1000 / 0.2 * 0.9)


def exported(scene, motion_steps=65):
    snapshot, report, _ = export_probe.through_engine(scene, motion_steps=motion_steps)
    return snapshot["camera"], [entry[:2] for entry in report.entries()]


def test_knots_where_the_path_bends(film, lens):
    wall(film, WIDTH / 2)
    camera, report = exported(film)
    assert "lens_knots" not in camera and not report
    drive(lens, "focus_distance", "25 + 75 * (frame - 10)")
    camera, report = exported(film)
    assert camera["lens_knots"] == pytest.approx(np.array([[5, 25], [5, 100]])) and not report
    drive(lens, "aperture_fstop", "(1 + 3 * (frame - 10)) / 16")
    bent = exported(film)[0]["lens_knots"]
    assert 5 <= len(bent) <= 65
    time = np.linspace(0, 1, len(bent))
    assert bent == pytest.approx(np.stack([8 / (1 + 3 * time), 25 + 75 * time], 1), rel=1e-5)
    assert len(exported(film, motion_steps=3)[0]["lens_knots"]) == 3


def test_without_depth_of_field_nothing_is_asked_of_the_lens(film, lens):
    wall(film, WIDTH / 2)
    drive(lens, "focus_distance", "25 + 75 * (frame - 10)")
    lens.use_dof = False
    camera, report = exported(film)
    assert "lens_knots" not in camera and camera["lens_radius"] == 0 and not report


def test_a_camera_that_does_not_blur_keeps_its_lens(film, lens):
    if not hasattr(film.camera, "cycles"):
        pytest.skip("the switch is Cycles'")
    wall(film, WIDTH / 2)
    drive(lens, "focus_distance", "25 + 75 * (frame - 10)")
    film.camera.cycles.use_motion_blur = False
    assert "lens_knots" not in exported(film)[0]


def test_a_focus_object_in_the_lens_is_named(film, lens):
    """At the shutter's end it lies in the camera's plane."""
    wall(film, WIDTH / 2)
    lens.focus_object = scene_parts.add_object(film, "Target", None, (0, 0, 0))
    drive(lens.focus_object, "location", "50 * (frame - 10)", 2)
    camera, report = exported(film)
    ((name, message),) = report
    assert name == "camera 'Camera'" and "focuses on itself within the shutter" in message
    assert (camera["lens_knots"][:, 1] > 0).all()
    assert bpy.context.scene.frame_current == 10
