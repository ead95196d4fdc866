# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows of what moves against Cycles of the same Blender: a ball that flies over a floor.

The camera does not see the ball.  What it sees of moving things differs by design: Cycles lights a
surface at the time of each sample, Granita once, with the mean over the shutter.
"""

import numpy as np
import pytest
from motion_parts import drive, open_shutter
from scene_parts import set_world
from test_lights import add_light, both, expect_alike, lambert, set_stage

# As for lights at rest: the same noise and no more.  Measured on 3.4: .0047 to .0054.
BLURRED = 0.025


@pytest.fixture
def flight(scene):
    """The ball crosses 2.4 m, more than its width, while the shutter is open."""
    ball = set_stage(scene, lambert())
    open_shutter(scene, 1.0)
    drive(ball, "location", "2.4 * (frame - 10)", 0)
    ball.visible_camera = False
    return ball


def test_a_moving_balls_shadow_under_a_sun(scene, flight, render):
    add_light(scene, "SUN", 2.0, angle=0.0)
    expect_alike(scene, render, BLURRED)


def test_a_moving_balls_shadow_under_a_soft_lamp(scene, flight, render):
    add_light(scene, "AREA", 300.0, size=1.5)
    expect_alike(scene, render, BLURRED)


def test_a_moving_balls_occlusion_of_the_world(scene, flight, render):
    set_world(scene, (0.5, 0.7, 1.0))
    expect_alike(scene, render, BLURRED)


def test_a_floor_that_flies_with_the_ball_keeps_its_shadow_sharp(scene, flight, render):
    """Both and the camera move as one: the picture is that of a scene at rest."""
    add_light(scene, "SUN", 2.0, angle=0.0)
    flight.visible_camera = True
    scene.render.use_motion_blur = False
    at_rest = both(scene, render)[0]
    scene.render.use_motion_blur = True
    for thing in (scene.objects["Floor"], scene.camera):
        drive(thing, "location", "2.4 * (frame - 10)", 0)
    moving = both(scene, render)[0]
    # Rounding of moved points alone: an edge of a shadow may fall to a vertex's other side.
    assert np.sqrt(np.mean((moving - at_rest) ** 2)) < 0.005 * at_rest.mean()
