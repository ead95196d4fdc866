# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender 5 that say how a tree is made: zones that repeat, closures, bundles, menus, switches; and outputs in
groups, one of which is taken.  Blender itself makes the tree that is meant, as it does for Cycles."""

import bpy

from .used_nodes import any_node_of

# bl_idnames begin so; groups, reroutes and frames are read as they are.
_MAKERS = (
    "FunctionNode",
    "GeometryNode",
    "NodeClosure",
    "NodeCombine",
    "NodeEnable",
    "NodeEvaluate",
    "NodeImplicit",
    "NodeJoin",
    "NodeSeparate",
)


def inlined(datablock):
    """What has the node tree to be read, as its `node_tree`; that lives as long as this is kept.

    Args:
        datablock: Material, World or Light, evaluated.

    Returns:
        The datablock itself where its tree, and groups in it, hold nodes that are shaded alone.
    """
    kinds = getattr(bpy.types, "InlineShaderNodes", None)
    if kinds is None:
        return datablock
    tree = datablock.node_tree
    groups = [n.node_tree for n in tree.nodes if n.type == "GROUP" and n.node_tree is not None]
    if not (any_node_of([tree], _is_maker) or any_node_of(groups, _is_output)):
        return datablock
    if isinstance(datablock, bpy.types.Material):
        return kinds.from_material(datablock)
    return (kinds.from_world if isinstance(datablock, bpy.types.World) else kinds.from_light)(
        datablock
    )


def _is_output(node):
    return node.type in {"OUTPUT_LIGHT", "OUTPUT_MATERIAL", "OUTPUT_WORLD"}


def _is_maker(node):
    return node.bl_idname.startswith(_MAKERS)
