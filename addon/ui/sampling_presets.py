# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of what is quality against time: those that come with Granita, and the artist's own.

Granita's lie in its own folder, where Blender does not look for what may be removed or replaced: Blender 3.4 knows no
folders of add-ons, and later ones would delete files of a legacy add-on.
"""

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from .engine_panel import EnginePanel

SHIPPED = Path(__file__).resolve().parent.parent / "presets"
SUBDIR = "granita/sampling"  # of the user's presets


class GRANITA_OT_sampling_preset_add(AddPresetBase, bpy.types.Operator):
    """Add or remove a preset of samples and rates"""

    bl_idname = "render.granita_sampling_preset_add"
    bl_label = "Add Sampling Preset"
    preset_menu = "GRANITA_RENDER_PT_sampling_presets"
    preset_subdir = SUBDIR
    preset_defines = ("settings = bpy.context.scene.granita",)
    preset_values = (
        "settings.samples",
        "settings.preview_samples",
        "settings.noise_threshold",
        "settings.min_samples",
        "settings.sampling",
        "settings.time_samples",
        "settings.light_samples",
        "settings.shading_threshold",
        "settings.opacity_threshold",
        "settings.dicing_rate",
        "settings.shading_rate",
        "settings.motion_factor",
        "settings.focus_factor",
    )

    def execute(self, context):
        if (SHIPPED / f"{self.as_filename(self.name)}.py").exists():
            self.report({"WARNING"}, f"'{self.name}' comes with Granita and stays as it is")
            return {"CANCELLED"}
        return super().execute(context)


class GRANITA_RENDER_PT_sampling_presets(PresetPanel, EnginePanel, bpy.types.Panel):
    bl_idname = "GRANITA_RENDER_PT_sampling_presets"
    bl_label = "Sampling Presets"

    @staticmethod
    def post_cb(context, *_):
        """3D views hear of it: no evaluation follows what a script sets."""
        context.scene.update_tag()

    def draw(self, context):
        self.layout.emboss = "PULLDOWN_MENU"
        self.layout.operator_context = "EXEC_DEFAULT"
        self.path_menu(
            [str(SHIPPED), *bpy.utils.preset_paths(SUBDIR)],
            "script.execute_preset",
            filter_ext=lambda ext: ext == ".py",
            add_operator=GRANITA_OT_sampling_preset_add.bl_idname,
            display_name=lambda path: bpy.path.display_name(path, title_case=False),
        )


_CLASSES = (GRANITA_OT_sampling_preset_add, GRANITA_RENDER_PT_sampling_presets)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
