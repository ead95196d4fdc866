# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view shows in Rendered shading, kept with the view: `space.shading.granita`, as Cycles keeps its own."""

import bpy

from ..passes import PASSES

# Depth is white all over, and Vector is read of frames beside this one.
_NOT_SHOWN = {"Depth", "Vector"}
_SHOWN = {p.native.upper().replace(" ", "_"): p.native for p in PASSES}


class GranitaViewSettings(bpy.types.PropertyGroup):
    render_pass: bpy.props.EnumProperty(
        name="Pass",
        description="What Rendered shading shows, by the names of the view layer's passes",
        items=[
            (identifier, name, f"The pass {name}", number)
            for number, (identifier, name) in enumerate(_SHOWN.items())
            if name not in _NOT_SHOWN
        ],
        default="COMBINED",
        options=set(),
    )
    use_time: bpy.props.BoolProperty(
        name="One Time",
        description="Show the scene as it is at one time of the shutter, without blur",
        default=False,
        options=set(),
    )
    time: bpy.props.FloatProperty(
        name="Time",
        description="Where in the shutter: 0 when it opens, 1 when it closes",
        default=0.5,
        min=0.0,
        max=1.0,
        options=set(),
    )
    use_paths: bpy.props.BoolProperty(
        name="Motion Paths",
        description="Draw over the picture where the middle of each thing goes while the shutter is open, with a dot "
        "where it ends",
        default=False,
        options=set(),
    )


def native_name(render_pass):
    """Of the setting: the pass in the table of passes.py."""
    return _SHOWN[render_pass]


def register():
    bpy.utils.register_class(GranitaViewSettings)
    bpy.types.View3DShading.granita = bpy.props.PointerProperty(type=GranitaViewSettings)


def unregister():
    del bpy.types.View3DShading.granita
    bpy.utils.unregister_class(GranitaViewSettings)
