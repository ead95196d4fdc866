# SPDX-License-Identifier: GPL-3.0-or-later
"""The material's tab: what Blender shows to other engines alone."""

import bpy

from .engine_panel import EnginePanel


class GRANITA_MATERIAL_PT_settings(EnginePanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.material is not None

    def draw(self, context):
        self.column().prop(context.material, "pass_index")


register, unregister = bpy.utils.register_classes_factory((GRANITA_MATERIAL_PT_settings,))
