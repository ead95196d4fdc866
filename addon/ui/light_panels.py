# SPDX-License-Identifier: GPL-3.0-or-later
"""The light's tab: what the export reads of a light, and nothing else (shading/light.py)."""

import bpy

from ..export.shading.light import shadow_switch
from .engine_panel import EnginePanel


class _LightPanel(EnginePanel):
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.light is not None


def _draw_light(layout, light):
    def draw(column, name, **how):  # what this Blender's lights have
        if hasattr(light, name):
            column.prop(light, name, **how)

    layout.use_property_split = True
    column = layout.column()
    draw(column, "use_temperature")
    if getattr(light, "use_temperature", False):
        draw(column, "temperature")
    column.prop(
        light, "color", text="Tint" if getattr(light, "use_temperature", False) else "Color"
    )
    column = layout.column()
    column.prop(light, "energy")
    draw(column, "exposure")
    draw(column, "normalize")
    column = layout.column()
    if light.type in {"POINT", "SPOT"}:
        column.prop(light, "shadow_soft_size", text="Radius")
        draw(column, "use_soft_falloff")
    elif light.type == "SUN":
        column.prop(light, "angle")
    elif light.shape in {"SQUARE", "DISK"}:
        column.prop(light, "shape")
        column.prop(light, "size")
    else:
        column.prop(light, "shape")
        sizes = column.column(align=True)
        sizes.prop(light, "size", text="Size X")
        sizes.prop(light, "size_y", text="Y")
    layout.column().prop(*shadow_switch(light), text="Cast Shadow")
    cycles = getattr(light, "cycles", None)
    if hasattr(cycles, "max_bounces"):
        layout.column().prop(cycles, "max_bounces")


class GRANITA_LIGHT_PT_light(_LightPanel, bpy.types.Panel):
    bl_label = "Light"

    def draw(self, context):
        self.layout.row().prop(context.light, "type", expand=True)
        _draw_light(self.layout, context.light)


class GRANITA_LIGHT_PT_beam(_LightPanel, bpy.types.Panel):
    bl_label = "Beam Shape"
    bl_parent_id = "GRANITA_LIGHT_PT_light"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.light.type in {"SPOT", "AREA"}

    def draw(self, context):
        light = context.light
        self.layout.use_property_split = True
        column = self.layout.column()
        if light.type == "AREA":
            column.prop(light, "spread", text="Spread")
        else:
            column.prop(light, "spot_size", text="Angle")
            column.prop(light, "spot_blend", text="Blend", slider=True)
            column.prop(light, "show_cone")


class GRANITA_LIGHT_PT_nodes(_LightPanel, bpy.types.Panel):
    """Constants that feed an Emission node count; the rest is named at the render."""

    bl_label = "Nodes"

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.use_property_split = True
        layout.prop(light, "use_nodes", icon="NODETREE")
        if light.use_nodes and light.node_tree is not None:
            output = light.node_tree.get_output_node("CYCLES")
            if output is None:
                layout.label(text="No output node")
            else:
                layout.template_node_view(light.node_tree, output, output.inputs["Surface"])


class GRANITA_NODE_PT_light(_LightPanel, bpy.types.Panel):
    """The same beside the light's nodes."""

    bl_label = "Light"
    bl_space_type = "NODE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Options"

    @classmethod
    def poll(cls, context):
        return getattr(context, "light", None) is not None and super().poll(context)

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.row().prop(context.light, "type")
        _draw_light(self.layout, context.light)


_CLASSES = (
    GRANITA_LIGHT_PT_light,
    GRANITA_LIGHT_PT_beam,
    GRANITA_LIGHT_PT_nodes,
    GRANITA_NODE_PT_light,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
