# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow linking of a light, where Blender shows it to Cycles alone (4.0 to 4.4; panels of Blender's own
serve all engines later)."""

import bpy

from .engine_panel import EnginePanel


class _LinkingPanel(EnginePanel):
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return (
            super().poll(context)
            and getattr(context.object, "light_linking", None) is not None
            and context.object.type == "LIGHT"
            and not hasattr(bpy.types, "OBJECT_PT_light_linking")
        )

    def draw_collection(self, linking, what, link):
        self.layout.use_property_split = True
        name = f"{what}_collection"
        new = f"object.light_linking_{name}_new"
        self.layout.column().template_ID(linking, name, new=new)
        if getattr(linking, name) is None:
            return
        row = self.layout.row()
        row.column().template_light_linking_collection(row, linking, name)
        buttons = row.column(align=True)
        buttons.operator(link, icon="ADD", text="").link_state = "INCLUDE"
        remove = "object.light_linking_unlink_from_collection"
        buttons.operator(remove, icon="REMOVE", text="")


class GRANITA_OBJECT_PT_light_linking(_LinkingPanel, bpy.types.Panel):
    bl_label = "Light Linking"

    def draw(self, context):
        link = "object.light_linking_receivers_link"
        self.draw_collection(context.object.light_linking, "receiver", link)


class GRANITA_OBJECT_PT_shadow_linking(_LinkingPanel, bpy.types.Panel):
    bl_label = "Shadow Linking"

    def draw(self, context):
        link = "object.light_linking_blockers_link"
        self.draw_collection(context.object.light_linking, "blocker", link)


_CLASSES = (GRANITA_OBJECT_PT_light_linking, GRANITA_OBJECT_PT_shadow_linking)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
