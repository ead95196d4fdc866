# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of exported motion share: a scene with a shutter, formulas of time.

No fixtures: pytest holds on to imported ones, they to this module and it to `bpy`, and bpy 4.2
crashes at exit when it is still held.
"""

import bpy
import scene_parts
from export_probe import knots_of


def with_shutter(scene):
    """The scene with motion blur: shutter of half a frame around frame 10."""
    scene_parts.add_camera(scene, (0, 0, 10))
    return open_shutter(scene, 0.5)


def open_shutter(scene, frames):
    """Around frame 10."""
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = frames
    set_position(scene, "CENTER")
    scene.frame_set(10)
    return scene


def set_position(scene, position):
    owner = scene.render if hasattr(scene.render, "motion_blur_position") else scene.cycles
    owner.motion_blur_position = position


def drive(owner, path, expression, index=-1):
    """A property that is a formula of `frame`, with its fraction."""
    owner.driver_add(path, index).driver.expression = expression


def xs(snapshot, name):
    return knots_of(snapshot, name)[:, 0, 3]


def shape_key(thing, name="Up", lift=1.0):
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name=name)
    for point in key.data:
        point.co.z += lift
    return key


def on_every_step(tell):
    """(before, after) for `export_probe.through_engine`: tell(scene, depsgraph) is called at each
    change of time in between."""

    def before(_depsgraph):
        bpy.app.handlers.frame_change_post.append(tell)

    def after(_depsgraph):
        bpy.app.handlers.frame_change_post.remove(tell)

    return {"before": before, "after": after}
