# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view shows in Rendered shading, kept with the view: `space.shading.granita`, as Cycles keeps its own."""

import bpy

from .. import passes

# Depth is white all over, and Vector is read of frames beside this one.
_NOT_SHOWN = {"Depth", "Vector"}
# Denoising Data repeats others.
_SHOWN = {
    p.native.upper().replace(" ", "_"): p.native
    for p in passes.PASSES
    if p.wanted != "denoising_store_passes"
}
COMBINED = passes.PASSES[0]


class GranitaViewSettings(bpy.types.PropertyGroup):
    render_pass: bpy.props.EnumProperty(
        name="Pass",
        description="What Rendered shading shows, by the names of the view layer's passes",
        items=[
            (identifier, name, f"The pass {name}", number)
            for number, (identifier, name) in enumerate(_SHOWN.items())
            if name not in _NOT_SHOWN
        ]
        + [
            ("AOV", "Shader AOV", "An output of materials, which the view layer names", len(_SHOWN))
        ],
        default="COMBINED",
        options=set(),
    )
    aov_name: bpy.props.StringProperty(
        name="AOV",
        description="Which of the view layer's shader AOVs is shown",
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


def shown_pass(settings, view_layer):
    """The Pass that a view shows; Combined for an AOV that the view layer has not."""
    if settings.render_pass == "AOV":
        made = passes.custom(view_layer)
        return next((p for p in made if p.native == settings.aov_name), COMBINED)
    return next(p for p in passes.PASSES if p.native == _SHOWN[settings.render_pass])


def register():
    bpy.utils.register_class(GranitaViewSettings)
    bpy.types.View3DShading.granita = bpy.props.PointerProperty(type=GranitaViewSettings)


def unregister():
    del bpy.types.View3DShading.granita
    bpy.utils.unregister_class(GranitaViewSettings)
