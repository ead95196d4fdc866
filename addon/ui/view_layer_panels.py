# SPDX-License-Identifier: GPL-3.0-or-later
"""The view layer's tab: what it leaves out, and what it has in place of the scene's."""

import bpy

from .engine_panel import EnginePanel


class _LayerPanel(EnginePanel):
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}


class GRANITA_VIEWLAYER_PT_filter(_LayerPanel, bpy.types.Panel):
    bl_label = "Filter"

    def draw(self, context):
        layer = context.view_layer
        column = self.column("Include")
        column.prop(layer, "use_sky", text="Environment")
        column.prop(layer, "use_solid", text="Surfaces")
        column.prop(layer, "use_strand", text="Hair")
        row = column.row()
        row.active = context.scene.render.use_motion_blur
        row.prop(layer, "use_motion_blur", text="Motion Blur")


class GRANITA_VIEWLAYER_PT_override(_LayerPanel, bpy.types.Panel):
    bl_label = "Override"

    def draw(self, context):
        layer = context.view_layer
        column = self.column()
        column.prop(layer, "material_override")
        if hasattr(layer, "world_override"):
            column.prop(layer, "world_override")
        column.prop(layer, "samples")


_CLASSES = (GRANITA_VIEWLAYER_PT_filter, GRANITA_VIEWLAYER_PT_override)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
