# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur beyond the shutter: rolling rows, and what an object says for itself."""

import bpy

from .engine_panel import EnginePanel


class GRANITA_RENDER_PT_rolling_shutter(bpy.types.Panel):
    """Cycles' settings, where its add-on is enabled: Blender has none."""

    bl_label = "Rolling Shutter"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_parent_id = "GRANITA_RENDER_PT_motion_blur"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return hasattr(getattr(context.scene, "cycles", None), "rolling_shutter_type")

    def draw(self, context):
        cycles = context.scene.cycles
        column = self.layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.active = context.scene.render.use_motion_blur
        column.prop(cycles, "rolling_shutter_type")
        row = column.row()
        row.active = cycles.rolling_shutter_type != "NONE"
        row.prop(cycles, "rolling_shutter_duration", text="Duration")


class GRANITA_OBJECT_PT_motion_blur(EnginePanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        types = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CAMERA", "CURVES", "POINTCLOUD"}
        return (
            super().poll(context)
            and context.object is not None
            and (context.object.type in types or context.object.is_instancer)
        )

    @staticmethod
    def settings(context):
        """The ones that count (export/blur_settings.py)."""
        return getattr(context.object, "cycles", None) or context.object.granita

    def draw_header(self, context):
        self.layout.active = context.scene.render.use_motion_blur
        self.layout.prop(self.settings(context), "use_motion_blur", text="")

    def draw(self, context):
        settings = self.settings(context)
        column = self.layout.column()
        column.use_property_split = True
        column.active = context.scene.render.use_motion_blur and settings.use_motion_blur
        column.prop(settings, "motion_steps", text="Steps")
        if context.object.type != "CAMERA":
            column.prop(settings, "use_deform_motion", text="Deformation")


_CLASSES = (GRANITA_RENDER_PT_rolling_shutter, GRANITA_OBJECT_PT_motion_blur)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
