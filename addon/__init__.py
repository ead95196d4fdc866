# SPDX-License-Identifier: GPL-3.0-or-later
"""Granita: a Reyes render engine for Blender.

Registers the parts in rank order (settings, panels, engine) and takes them away in reverse.
Nothing here needs the native module: without it the add-on still registers, and the render panel
and every render say what is wrong (see bridge.py).
"""

bl_info = {
    "name": "Granita",
    "description": "Reyes renderer: motion blur, depth of field and fine geometry, cheap and clean",
    "author": "The Granita authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine > Granita",
    "category": "Render",
}


def _parts():
    from . import engine, preferences, properties, ui, written_frames
    from .parts import part_output
    from .viewport import shading_settings

    # Of the handlers those of the last come first: what was written is looked at before its path is put back.
    return (
        properties,
        shading_settings,
        preferences,
        ui,
        part_output,
        written_frames,
        engine,
    )


def register():
    for part in _parts():
        part.register()


def unregister():
    for part in reversed(_parts()):
        part.unregister()
