# SPDX-License-Identifier: GPL-3.0-or-later
"""The view layer tab: which passes are made (the table of passes.py)."""

import bpy

from .. import passes


class GRANITA_VIEWLAYER_PT_passes(bpy.types.Panel):
    bl_label = "Passes"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "view_layer"
    COMPAT_ENGINES = {"GRANITA"}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for p in passes.PASSES:
            if p.wanted is not None and hasattr(context.view_layer, p.wanted):
                layout.prop(context.view_layer, p.wanted, text=p.native)


def register():
    bpy.utils.register_class(GRANITA_VIEWLAYER_PT_passes)


def unregister():
    bpy.utils.unregister_class(GRANITA_VIEWLAYER_PT_passes)
