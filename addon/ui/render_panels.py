# SPDX-License-Identifier: GPL-3.0-or-later
"""The render tab: scene.granita, and the settings of Blender that have no common panel."""

import bpy

from .. import bridge, passes
from ..export.scene.light_paths import LIMITS
from ..export.shading.world import world_of
from .engine_panel import EnginePanel
from .problem import draw_problem
from .sampling_presets import GRANITA_RENDER_PT_sampling_presets


def shutter_position_owner(scene):
    """Blender 4.2 moved `motion_blur_position` out of Cycles' settings; None where neither is."""
    for owner in (scene.render, getattr(scene, "cycles", None)):
        if hasattr(owner, "motion_blur_position"):
            return owner
    return None


class RenderPanel(EnginePanel):
    bl_context = "render"


class GRANITA_RENDER_PT_device(RenderPanel, bpy.types.Panel):
    bl_label = "Granita"
    bl_options = {"HIDE_HEADER"}

    def draw(self, context):
        column = self.column()
        problem = bridge.problem()
        if problem:
            draw_problem(column, problem)
        column.prop(context.scene.granita, "device")


class GRANITA_RENDER_PT_sampling(RenderPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw_header_preset(self, context):
        GRANITA_RENDER_PT_sampling_presets.draw_panel_header(self.layout)

    def draw(self, context):
        settings = context.scene.granita
        column = self.column()
        column.prop(settings, "samples")
        column.prop(settings, "noise_threshold")
        row = column.row()
        row.active = settings.noise_threshold > 0
        row.prop(settings, "min_samples")
        column.prop(settings, "preview_samples")
        column.prop(settings, "sampling")
        if settings.sampling == "REGULAR":
            column.prop(settings, "time_samples")
        column.prop(settings, "light_samples")
        column.prop(settings, "shading_threshold")
        column.prop(settings, "opacity_threshold")
        row = column.row(align=True)
        row.prop(settings, "seed")
        row.prop(settings, "animate_seed", text="", icon="TIME")
        column.operator("scene.granita_denoise")


class GRANITA_RENDER_PT_light_paths(RenderPanel, bpy.types.Panel):
    bl_label = "Light Paths"

    def draw(self, context):
        settings = context.scene.granita
        column = self.column()
        column.prop(settings, "bounces")
        cycles = getattr(context.scene, "cycles", None)
        if settings.bounces == "NONE" or cycles is None:
            return
        for name, _, _ in LIMITS:
            column.prop(cycles, name)


class GRANITA_RENDER_PT_fast_gi(RenderPanel, bpy.types.Panel):
    bl_label = "Fast GI Approximation"
    bl_parent_id = "GRANITA_RENDER_PT_light_paths"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and getattr(context.scene, "cycles", None) is not None

    def draw_header(self, context):
        self.layout.prop(context.scene.cycles, "use_fast_gi", text="")

    def draw(self, context):
        scene = context.scene
        column = self.column()
        column.active = scene.cycles.use_fast_gi
        column.prop(scene.cycles, "fast_gi_method", text="Method")
        world = world_of(scene, context.view_layer)
        if world is not None:
            column.prop(world.light_settings, "ao_factor", text="AO Factor")
            column.prop(world.light_settings, "distance", text="AO Distance")
        if scene.cycles.fast_gi_method == "REPLACE":
            column.prop(scene.cycles, "ao_bounces", text="Viewport Bounces")
            column.prop(scene.cycles, "ao_bounces_render", text="Render Bounces")


class GRANITA_RENDER_PT_geometry(RenderPanel, bpy.types.Panel):
    bl_label = "Geometry"

    def draw(self, context):
        settings = context.scene.granita
        column = self.column()
        column.prop(settings, "dicing_rate")
        column.prop(settings, "shading_rate")
        column.prop(settings, "motion_factor")
        column.prop(settings, "focus_factor")


class GRANITA_RENDER_PT_motion_blur(RenderPanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context):
        scene = context.scene
        column = self.column()
        column.active = scene.render.use_motion_blur
        owner = shutter_position_owner(scene)
        if owner is not None:
            column.prop(owner, "motion_blur_position", text="Position")
        column.prop(scene.render, "motion_blur_shutter")
        column.prop(scene.granita, "motion_steps")


class GRANITA_RENDER_PT_shutter_curve(RenderPanel, bpy.types.Panel):
    bl_label = "Shutter Curve"
    bl_parent_id = "GRANITA_RENDER_PT_motion_blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        render = context.scene.render
        column = self.layout.column()
        column.active = render.use_motion_blur
        column.template_curve_mapping(render, "motion_blur_shutter_curve")
        row = column.row(align=True)
        for shape, icon in (
            ("SMOOTH", "SMOOTHCURVE"),
            ("ROUND", "SPHERECURVE"),
            ("ROOT", "ROOTCURVE"),
            ("SHARP", "SHARPCURVE"),
            ("LINE", "LINCURVE"),
            ("MAX", "NOCURVE"),
        ):
            row.operator("render.shutter_curve_preset", icon=icon, text="").shape = shape


class GRANITA_RENDER_PT_film(RenderPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        settings = context.scene.granita
        column = self.column()
        column.prop(passes.exposure_owner(context.scene), "film_exposure")
        column.prop(settings, "pixel_filter")
        column.prop(settings, "filter_width")
        column.prop(context.scene.render, "film_transparent", text="Transparent")


class GRANITA_RENDER_PT_performance(RenderPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        render = context.scene.render
        settings = context.scene.granita
        column = self.column()
        column.prop(render, "threads_mode")
        threads = column.column()
        threads.enabled = render.threads_mode == "FIXED"
        threads.prop(render, "threads")
        column.prop(settings, "bucket_size")
        column.prop(settings, "grid_size")
        column.prop(settings, "z_batch_size")
        column.prop(render, "use_persistent_data", text="Persistent Data")


_CLASSES = (
    GRANITA_RENDER_PT_device,
    GRANITA_RENDER_PT_sampling,
    GRANITA_RENDER_PT_light_paths,
    GRANITA_RENDER_PT_fast_gi,
    GRANITA_RENDER_PT_geometry,
    GRANITA_RENDER_PT_motion_blur,
    GRANITA_RENDER_PT_shutter_curve,
    GRANITA_RENDER_PT_film,
    GRANITA_RENDER_PT_performance,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
