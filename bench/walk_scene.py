# SPDX-License-Identifier: GPL-3.0-or-later
"""The rooms of bounced_scenes.py as a camera sees them that walks past their open side and turns to
them."""

import bounced_scenes

ASIDE, TURN = 0.35, 0.08  # metres and radians to both sides


def build(name, frames):
    """The scene of that name; the camera walks in the frames 1 to `frames`."""
    scene = bounced_scenes.SCENES[name]()
    camera = scene.camera
    for frame, side in ((1, -1), (frames, 1)):
        camera.location.x, camera.rotation_euler.y = side * ASIDE, side * TURN
        camera.keyframe_insert("location", frame=frame)
        camera.keyframe_insert("rotation_euler", frame=frame)
    return scene
