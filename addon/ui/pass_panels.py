# SPDX-License-Identifier: GPL-3.0-or-later
"""The view layer's passes, where Cycles has them.  Those that Granita does not make (the table of passes.py)
are greyed and can still be switched: files come with them."""

import bpy

from .. import passes
from .engine_panel import EnginePanel

_PARTS = ("direct", "indirect", "color")
_LOBES = ("diffuse", "glossy", "transmission")


class _PassPanel(EnginePanel):
    bl_context = "view_layer"

    def show(self, column, owner, name, text):
        """A switch, where this Blender has it."""
        if not hasattr(owner, name):
            return
        row = column.row()
        row.active = name in passes.SERVED
        row.prop(owner, name, text=text)

    def begin(self, heading=""):
        return self.column(heading, align=True)


class GRANITA_VIEWLAYER_PT_passes(_PassPanel, bpy.types.Panel):
    bl_label = "Passes"

    def draw(self, context):
        missing = passes.missing(context.view_layer)
        if missing:
            self.begin().label(text=f"Not rendered: {', '.join(missing)}", icon="INFO")


class GRANITA_VIEWLAYER_PT_passes_data(_PassPanel, bpy.types.Panel):
    bl_label = "Data"
    bl_parent_id = "GRANITA_VIEWLAYER_PT_passes"

    _SHOWN = (
        ("z", "Z"),
        ("mist", "Mist"),
        ("position", "Position"),
        ("normal", "Normal"),
        ("vector", "Vector"),
        ("uv", "UV"),
        ("grease_pencil", "Grease Pencil"),
    )

    def draw(self, context):
        layer = context.view_layer
        column = self.begin("Include")
        for name, text in self._SHOWN:
            self.show(column, layer, f"use_pass_{name}", text)
        self.show(
            column, getattr(layer, "cycles", None), "denoising_store_passes", "Denoising Data"
        )
        column = self.begin("Indexes")
        self.show(column, layer, "use_pass_object_index", "Object Index")
        self.show(column, layer, "use_pass_material_index", "Material Index")
        self.layout.prop(layer, "pass_alpha_threshold")


class GRANITA_VIEWLAYER_PT_passes_light(_PassPanel, bpy.types.Panel):
    bl_label = "Light"
    bl_parent_id = "GRANITA_VIEWLAYER_PT_passes"

    def draw(self, context):
        layer = context.view_layer
        for lobe in _LOBES:
            column = self.begin(lobe.capitalize())
            for part in _PARTS:
                self.show(column, layer, f"use_pass_{lobe}_{part}", part.capitalize())
        column = self.begin("Volume")
        for part in _PARTS[:2]:
            name = f"use_pass_volume_{part}"
            self.show(column, getattr(layer, "cycles", None), name, part.capitalize())
        column = self.begin("Other")
        for name, text in (
            ("emit", "Emission"),
            ("environment", "Environment"),
            ("shadow", "Shadow"),
            ("ambient_occlusion", "Ambient Occlusion"),
        ):
            self.show(column, layer, f"use_pass_{name}", text)
        cycles = getattr(layer, "cycles", None)
        self.show(column, cycles, "use_pass_shadow_catcher", "Shadow Catcher")


class GRANITA_VIEWLAYER_PT_passes_cryptomatte(_PassPanel, bpy.types.Panel):
    bl_label = "Cryptomatte"
    bl_parent_id = "GRANITA_VIEWLAYER_PT_passes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column = self.begin("Include")
        for name in ("Object", "Material", "Asset"):
            self.show(column, context.view_layer, f"use_pass_cryptomatte_{name.lower()}", name)


class GRANITA_VIEWLAYER_PT_aovs(EnginePanel, bpy.types.Panel):
    """As Blender's own, whose parent is a panel of other engines."""

    bl_label = "Shader AOV"
    bl_context = "view_layer"
    bl_parent_id = "GRANITA_VIEWLAYER_PT_passes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layer = context.view_layer
        row = self.layout.row()
        row.template_list("VIEWLAYER_UL_aov", "", layer, "aovs", layer, "active_aov_index", rows=3)
        buttons = row.column(align=True)
        buttons.operator("scene.view_layer_add_aov", icon="ADD", text="")
        buttons.operator("scene.view_layer_remove_aov", icon="REMOVE", text="")
        if layer.active_aov and not layer.active_aov.is_valid:
            self.layout.label(text="Another pass has this name", icon="ERROR")


_CLASSES = (
    GRANITA_VIEWLAYER_PT_passes,
    GRANITA_VIEWLAYER_PT_passes_data,
    GRANITA_VIEWLAYER_PT_passes_light,
    GRANITA_VIEWLAYER_PT_passes_cryptomatte,
    GRANITA_VIEWLAYER_PT_aovs,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
