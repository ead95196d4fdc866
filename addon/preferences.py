# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's entry in the preferences: what is installed, what it runs on, and a report of both."""

import bpy

from . import bridge, system_report
from .ui.problem import draw_problem


class GranitaPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, _context):
        layout = self.layout
        problem = bridge.problem()
        if problem:
            draw_problem(layout, problem)
        else:
            column = layout.column(align=True)
            for name, value in system_report.native_lines():
                row = column.split(factor=0.2)
                row.label(text=name)
                row.label(text=value)
        layout.operator(CopySystemReport.bl_idname, icon="COPYDOWN")


class CopySystemReport(bpy.types.Operator):
    """Copy versions, processor and OpenGL to the clipboard, for a report of a fault"""

    bl_idname = "granita.copy_system_report"
    bl_label = "Copy System Report"

    def execute(self, context):
        app = bpy.app
        build = app.build_hash.decode(errors="replace")
        context.window_manager.clipboard = system_report.text(f"{app.version_string}, {build}")
        self.report({"INFO"}, "The system report is in the clipboard")
        return {"FINISHED"}


_CLASSES = (CopySystemReport, GranitaPreferences)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
