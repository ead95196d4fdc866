# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's entry in the preferences: whether the native module works here."""

import bpy

from . import bridge
from .ui.problem import draw_problem


class GranitaPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, _context):
        problem = bridge.problem()
        if problem:
            draw_problem(self.layout, problem)
        else:
            self.layout.label(text="The native module is loaded", icon="CHECKMARK")


def register():
    bpy.utils.register_class(GranitaPreferences)


def unregister():
    bpy.utils.unregister_class(GranitaPreferences)
