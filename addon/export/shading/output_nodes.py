# SPDX-License-Identifier: GPL-3.0-or-later
"""Which output node Cycles takes of a material, world or light, where groups hold some, too."""

import bpy

from .node_links import is_connected


def output_nodes(root):
    """[(Scope, output node)], those that come first connected first.

    Cycles connects groups before what holds them, and leaves alone what is connected.  From Blender 5.0 on trees whose
    groups hold outputs are made into one by Blender (inlined_tree.py), which has one.

    Args:
        root: Scope of the datablock's tree.
    """
    if bpy.app.version >= (5, 0, 0):
        own = root.tree.get_output_node("CYCLES")
        return [] if own is None else [(root, own)]
    found, entered, open_ = [], set(), [(root, root.groups())]
    while open_:
        scope, groups = open_[-1]
        # Where a tree is used again its outputs come too late.
        inner = next((group for group in groups if group.tree.as_pointer() not in entered), None)
        if inner is not None:
            entered.add(inner.tree.as_pointer())
            open_.append((inner, inner.groups()))
            continue
        open_.pop()
        output = scope.tree.get_output_node("CYCLES")
        if output is not None:
            found.append((scope, output))
    return found


def fed_socket(outputs, name):
    """(Scope, input socket) of the first output in which Cycles connects it, else of the last that has it; None where
    none does.

    Args:
        outputs: of `output_nodes`.
        name: of the socket.
    """
    last = None
    for scope, output in outputs:
        socket = output.inputs.get(name)
        if socket is None:
            continue
        last = scope, socket
        if is_connected(scope, socket):
            break
    return last
