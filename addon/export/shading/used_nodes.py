# SPDX-License-Identifier: GPL-3.0-or-later
"""What living node trees hold, before they are read."""


def any_node(materials, is_wanted):
    """Whether `is_wanted` is true of a node of evaluated Materials (or None), or of groups in them."""
    trees = [m.node_tree for m in materials if m is not None and m.use_nodes and m.node_tree]
    return any_node_of(trees, is_wanted)


def any_node_of(trees, is_wanted):
    """Whether `is_wanted` is true of a node of these trees, or of groups in them."""
    pending, entered = list(trees), set()
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
