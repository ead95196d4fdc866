# SPDX-License-Identifier: GPL-3.0-or-later
"""What living node trees hold, before they are read."""


def any_node(materials, is_wanted):
    """Whether `is_wanted` is true of a node of evaluated Materials (or None), or of groups in them."""
    pending = [m.node_tree for m in materials if m is not None and m.use_nodes and m.node_tree]
    entered = set()
    while pending:
        tree = pending.pop()
        if tree.as_pointer() in entered:
            continue
        entered.add(tree.as_pointer())
        for node in tree.nodes:
            if is_wanted(node):
                return True
            if node.type == "GROUP" and node.node_tree is not None:
                pending.append(node.node_tree)
    return False
