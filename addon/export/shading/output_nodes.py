# SPDX-License-Identifier: GPL-3.0-or-later
"""Which Material Output or World Output Cycles takes, where groups hold some, too."""

import bpy


def output_nodes(root):
    """[(Scope, output node)]: each socket is fed by the first in which it is linked.

    Cycles connects groups before what holds them, and leaves alone what is connected.  From Blender 5.0 on groups are
    looked into only where the tree itself has no output.

    Args:
        root: Scope of a material's or world's tree.
    """
    own = root.tree.get_output_node("CYCLES")
    if own is not None and bpy.app.version >= (5, 0, 0):
        return [(root, own)]
    found, entered, open_ = [], {root.tree.as_pointer()}, [(root, iter(root.tree.nodes))]
    while open_:
        scope, nodes = open_[-1]
        group = next((node for node in nodes if _is_new_group(node, entered)), None)
        if group is not None:
            entered.add(group.node_tree.as_pointer())
            inner = scope.inside(group)
            open_.append((inner, iter(inner.tree.nodes)))
            continue
        open_.pop()
        output = scope.tree.get_output_node("CYCLES")
        if output is not None:
            found.append((scope, output))
    return found


def _is_new_group(node, entered):
    """A tree that was entered before has nothing to add."""
    if node.type != "GROUP" or node.mute or node.node_tree is None:
        return False
    return node.node_tree.as_pointer() not in entered
