# SPDX-License-Identifier: GPL-3.0-or-later
"""The mapping that texture nodes have of their own, as files from before Blender 2.8 use it, against Cycles' output."""

import bpy
import pytest
from node_comparison import Tree, board, check, enum_values
from test_nodes_textures import SAMPLES, smooth_image

KINDS = "Noise Voronoi Wave Magic Checker Brick Gradient Gabor Musgrave Image Environment".split()
TYPES = enum_values("TexMapping", "vector_type")


def moved(node, kind, axes="XYZ"):
    mapping = node.texture_mapping
    mapping.vector_type = kind
    mapping.translation, mapping.rotation = (0.3, -0.2, 0.5), (0.4, -0.7, 1.1)
    mapping.scale = (1.3, 0.6, -0.8)
    mapping.mapping_x, mapping.mapping_y, mapping.mapping_z = axes
    return node


def texture(tree, kind):
    name = f"ShaderNodeTex{kind}"
    if not hasattr(bpy.types, name):
        pytest.skip("not in this Blender")
    node = tree.add(name)
    if kind in {"Image", "Environment"}:
        node.image = smooth_image("Image")
    return node


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("moves", TYPES)
def test_what_is_linked_is_moved(scene, render, kind, moves):
    tree = Tree(board(scene))
    node = moved(texture(tree, kind), moves)
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.emit(node.outputs[0], strength=2.0 if kind in {"Noise", "Gabor"} else 1.0)
    check(scene, render)


@pytest.mark.parametrize("kind", ["Magic", "Image", "Environment"])
def test_what_is_looked_up_without_a_link_is_moved(scene, render, kind):
    tree = Tree(board(scene))
    node = moved(texture(tree, kind), "POINT")
    node.texture_mapping.scale = (0.4, 0.3, -0.4)
    tree.emit(node.outputs[0])
    check(scene, render, SAMPLES)


def test_skies_are_turned(scene, render):
    tree = Tree(board(scene))
    node = moved(tree.add("ShaderNodeTexSky", sky_type="PREETHAM"), "POINT")
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.emit(node.outputs[0])
    check(scene, render, relative=True)


@pytest.mark.parametrize("axes", [("Z", "X", "Y"), ("NONE", "Y", "X"), ("X", "X", "NONE")])
def test_axes_are_taken_from_others_or_none(scene, render, axes):
    tree = Tree(board(scene))
    node = moved(texture(tree, "Magic"), "POINT", axes)
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.emit(node.outputs[0])
    check(scene, render)


def test_a_scale_of_nothing_is_no_fault(scene, render):
    tree = Tree(board(scene))
    node = moved(texture(tree, "Magic"), "TEXTURE")
    node.texture_mapping.scale = (0.0, 1.0, 1.0)
    tree.link(tree.attribute("A"), node.inputs["Vector"])
    tree.emit(node.outputs[0])
    passes = render(scene, "granita")
    assert all((values == values).all() for values in passes.values())
