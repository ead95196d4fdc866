# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs of supported nodes that are constants here, and what the artist is told where one is linked."""

UNREAD_OUTPUTS = {
    ("ShaderNodeNewGeometry", "Pointiness"): "is not evaluated: .5 everywhere",
    ("ShaderNodeNewGeometry", "Parametric"): "is not evaluated: 0 everywhere",
}


def report_unread(node, socket, owner, report):
    """Says so where an output that somebody reads is not evaluated."""
    message = UNREAD_OUTPUTS.get((node.bl_idname, socket.identifier))
    if message is not None:
        report(owner, f"node '{node.name}': its output '{socket.name}' {message}")
