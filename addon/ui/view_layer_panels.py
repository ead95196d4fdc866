# SPDX-License-Identifier: GPL-3.0-or-later
"""The view layer tab: which passes are made (the table of passes.py), AOVs among them."""

import bpy

from .. import passes
from .engine_panel import EnginePanel


class GRANITA_VIEWLAYER_PT_passes(EnginePanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for p in passes.PASSES:
            if p.wanted is not None and hasattr(context.view_layer, p.wanted):
                layout.prop(context.view_layer, p.wanted, text=p.native)
        layout.prop(context.view_layer, "pass_alpha_threshold")


class GRANITA_VIEWLAYER_PT_aovs(bpy.types.Panel):
    """As Blender's own, whose parent is a panel of other engines."""

    bl_label = "Shader AOV"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "view_layer"
    bl_parent_id = "GRANITA_VIEWLAYER_PT_passes"

    def draw(self, context):
        layer = context.view_layer
        row = self.layout.row()
        row.template_list("VIEWLAYER_UL_aov", "", layer, "aovs", layer, "active_aov_index", rows=3)
        buttons = row.column(align=True)
        buttons.operator("scene.view_layer_add_aov", icon="ADD", text="")
        buttons.operator("scene.view_layer_remove_aov", icon="REMOVE", text="")
        if layer.active_aov and not layer.active_aov.is_valid:
            self.layout.label(text="Another pass has this name", icon="ERROR")


_CLASSES = (GRANITA_VIEWLAYER_PT_passes, GRANITA_VIEWLAYER_PT_aovs)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
