# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar of 3D views: what Rendered shading shows there, and what it costs."""

import bpy

from ..viewport import loop
from .compare_operators import GRANITA_OT_compare_pictures, GRANITA_OT_keep_picture


class GRANITA_VIEW3D_PT_preview(bpy.types.Panel):
    bl_idname = "GRANITA_VIEW3D_PT_preview"
    bl_label = "Granita"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "View"
    COMPAT_ENGINES = {"GRANITA"}

    @classmethod
    def poll(cls, context):
        return (
            context.engine in cls.COMPAT_ENGINES and context.space_data.shading.type == "RENDERED"
        )

    def draw(self, context):
        scene, settings = context.scene, context.scene.granita
        column = self.layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        shown = context.space_data.shading.granita
        _draw_pass(column, context)
        column.prop(settings, "preview_pause")
        column.prop(settings, "preview_samples")
        column.prop(settings, "preview_moving")
        column.separator()
        column.prop(scene.render, "use_motion_blur")
        row = column.row()
        row.active = scene.render.use_motion_blur
        row.prop(scene.render, "motion_blur_shutter")
        row = column.row(heading="One Time")
        row.active = scene.render.use_motion_blur
        row.prop(shown, "use_time", text="")
        row = row.row()
        row.active = shown.use_time
        row.prop(shown, "time", text="", slider=True)
        column.prop(shown, "use_paths")
        row = column.row(align=True)
        row.operator(GRANITA_OT_keep_picture.bl_idname)
        row.operator(GRANITA_OT_compare_pictures.bl_idname)
        if scene.camera is not None and scene.camera.type == "CAMERA":
            lens = scene.camera.data.dof
            column.prop(lens, "use_dof")
            row = column.row()
            row.active = lens.use_dof
            row.prop(lens, "aperture_fstop")


class GRANITA_VIEW3D_PT_shading_pass(bpy.types.Panel):
    bl_label = "Render Pass"
    bl_parent_id = "VIEW3D_PT_shading"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"

    poll = GRANITA_VIEW3D_PT_preview.poll

    def draw(self, context):
        _draw_pass(self.layout, context)


class GRANITA_VIEW3D_PT_costs(bpy.types.Panel):
    bl_idname = "GRANITA_VIEW3D_PT_costs"
    bl_label = "What It Costs"
    bl_parent_id = GRANITA_VIEW3D_PT_preview.bl_idname
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column = self.layout.column(align=True)
        view = loop.view_of(context.area)
        if view is None:
            column.label(text="No picture yet")
            return
        _draw_lines(column, view.costs.lines())
        if view.costs.objects:
            column.separator()
            column.label(text="Dearest objects, dicing and shading:")
            _draw_lines(column, view.costs.object_lines())
        for line in view.warnings:
            column.label(text=line, icon="ERROR")


def _draw_lines(column, lines):
    for label, value in lines:
        row = column.split(factor=0.6)
        row.label(text=label)
        row.label(text=value)


def _draw_pass(layout, context):
    shading = context.space_data.shading.granita
    layout.prop(shading, "render_pass")
    if shading.render_pass == "AOV":
        layout.prop_search(shading, "aov_name", context.view_layer, "aovs")
        if shading.aov_name not in context.view_layer.aovs:
            layout.label(text="No such output: Combined is shown", icon="ERROR")


_CLASSES = (
    GRANITA_VIEW3D_PT_preview,
    GRANITA_VIEW3D_PT_costs,
    GRANITA_VIEW3D_PT_shading_pass,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
