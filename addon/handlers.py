# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that Blender calls at events, for as long as the add-on is on."""

import bpy


def registration(*handlers):
    """(register, unregister) of pairs (event, function): in this order, before those of others that are there, and
    whatever file is loaded meanwhile."""

    def register():
        for event, function in reversed(handlers):
            getattr(bpy.app.handlers, event).insert(0, bpy.app.handlers.persistent(function))

    def unregister():
        for event, function in handlers:
            getattr(bpy.app.handlers, event).remove(function)

    return register, unregister
