# SPDX-License-Identifier: GPL-3.0-or-later
"""AWS Deadline Cloud's adaptor for Blender sets the engine to one of the three that it knows; here scenes keep theirs.

Runs in Blender before the adaptor's own client, which brings its handlers along.
"""

import bpy
from blender_adaptor.BlenderClient.render_handlers import DefaultBlenderHandler


def set_render_scene(handler, data):
    handler.scene_name = data["render_scene"]
    bpy.context.window.scene = bpy.data.scenes[handler.scene_name]


DefaultBlenderHandler.set_render_scene = set_render_scene
