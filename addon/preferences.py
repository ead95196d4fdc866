# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's entry in the preferences: what is installed, what it runs on, a report of both, and the log."""

from pathlib import Path

import bpy

from . import bridge, session_log, system_report
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
        layout.operator(OpenLog.bl_idname, icon="TEXT")


def _system_report():
    build = bpy.app.build_hash.decode(errors="replace")
    return system_report.text(f"{bpy.app.version_string}, {build}")


class CopySystemReport(bpy.types.Operator):
    """Copy versions, processor and OpenGL to the clipboard, for a report of a fault"""

    bl_idname = "granita.copy_system_report"
    bl_label = "Copy System Report"

    def execute(self, context):
        context.window_manager.clipboard = _system_report()
        self.report({"INFO"}, "The system report is in the clipboard")
        return {"FINISHED"}


class OpenLog(bpy.types.Operator):
    """Open what final frames of this session told, with the newest report of a crash"""

    bl_idname = "granita.open_log"
    bl_label = "Open Log"

    def execute(self, _context):
        # Blender empties that folder at its end.
        file = Path(bpy.app.tempdir) / session_log.NAME
        try:
            file.write_text(session_log.text(_system_report()), encoding="utf-8")
        except OSError as error:
            self.report({"ERROR"}, f"'{file}' cannot be written: {error.strerror}")
            return {"CANCELLED"}
        return bpy.ops.wm.path_open(filepath=str(file))


_CLASSES = (CopySystemReport, OpenLog, GranitaPreferences)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
