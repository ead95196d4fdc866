# SPDX-License-Identifier: GPL-3.0-or-later
"""What rays see, and after how many bounces: settings that the export reads and that Blender shows to Cycles alone."""

import bpy

from ..export.shading.world import RAY_TYPES
from .engine_panel import EnginePanel


class _Panel(EnginePanel):
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and cls.concerns(context)


class GRANITA_OBJECT_PT_rays(_Panel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    _BOTH = (
        ("visible_camera", "Camera"),
        ("visible_diffuse", "Diffuse"),
        ("visible_glossy", "Glossy"),
        ("visible_transmission", "Transmission"),
        ("visible_volume_scatter", "Volume Scatter"),
    )
    _SURFACE = (*_BOTH, ("visible_shadow", "Shadow"))
    _TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "EMPTY", "LIGHT"}

    @classmethod
    def concerns(cls, context):
        return context.object is not None and context.object.type in cls._TYPES

    def draw(self, context):
        column = self.layout.column()
        column.use_property_split = True
        column.prop(context.object, "is_shadow_catcher")
        for name, text in self._BOTH if context.object.type == "LIGHT" else self._SURFACE:
            column.prop(context.object, name, text=text)


class GRANITA_WORLD_PT_rays(_Panel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "world"

    @classmethod
    def concerns(cls, context):
        # Cycles' add-on, which brings the switches, can be switched off.
        return hasattr(context.world, "cycles_visibility")

    def draw(self, context):
        column = self.layout.column()
        column.use_property_split = True
        for name in RAY_TYPES:
            column.prop(context.world.cycles_visibility, name)


class GRANITA_WORLD_PT_settings(_Panel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "world"

    @classmethod
    def concerns(cls, context):
        return hasattr(getattr(context.world, "cycles", None), "max_bounces")

    def draw(self, context):
        column = self.layout.column()
        column.use_property_split = True
        column.prop(context.world.cycles, "max_bounces")


_CLASSES = (GRANITA_OBJECT_PT_rays, GRANITA_WORLD_PT_rays, GRANITA_WORLD_PT_settings)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
