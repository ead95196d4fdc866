# SPDX-License-Identifier: GPL-3.0-or-later
"""What Simplify leaves out: settings of Cycles that the export reads and that its add-on shows to Cycles alone."""

import bpy

from .engine_panel import EnginePanel


class _Panel(EnginePanel):
    bl_label = "Culling"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and hasattr(context.scene, "cycles")


class GRANITA_RENDER_PT_culling(_Panel, bpy.types.Panel):
    bl_context = "render"
    bl_parent_id = "RENDER_PT_simplify"

    def draw(self, context):
        settings = context.scene.cycles
        column = self.column()
        column.active = context.scene.render.use_simplify
        for use, margin in (
            ("use_camera_cull", "camera_cull_margin"),
            ("use_distance_cull", "distance_cull_margin"),
        ):
            column.prop(settings, use)
            row = column.row()
            row.active = getattr(settings, use)
            row.prop(settings, margin)


class GRANITA_OBJECT_PT_culling(_Panel, bpy.types.Panel):
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and hasattr(context.object, "cycles")

    def draw(self, context):
        settings = context.scene.cycles
        column = self.column()
        for use in ("use_camera_cull", "use_distance_cull"):
            row = column.row()
            row.active = context.scene.render.use_simplify and getattr(settings, use)
            row.prop(context.object.cycles, use)


_CLASSES = (GRANITA_RENDER_PT_culling, GRANITA_OBJECT_PT_culling)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
