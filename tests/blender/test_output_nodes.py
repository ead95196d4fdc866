# SPDX-License-Identifier: GPL-3.0-or-later
"""Output nodes inside of groups: which of several is taken, against Cycles in the same Blender."""

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import render_both

RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class Tree:
    """Of a material or a world, or a group of such."""

    def __init__(self, tree, kind):
        self.tree, self.kind = tree, kind

    def output(self, color=None):
        """An output node, which shows a color or nothing."""
        output = self.tree.nodes.new(f"ShaderNodeOutput{self.kind}")
        if color is not None:
            shines = self.tree.nodes.new("ShaderNodeEmission")
            shines.inputs["Color"].default_value = (*color, 1.0)
            self.tree.links.new(shines.outputs[0], output.inputs["Surface"])

    def group(self):
        node = self.tree.nodes.new("ShaderNodeGroup")
        node.node_tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
        return Tree(node.node_tree, self.kind)


def inside_alone(tree):
    tree.group().output(GREEN)


def nested(tree):
    tree.group().group().output(GREEN)


def before_the_group(tree):
    tree.output(RED)
    tree.group().output(GREEN)


def behind_the_group(tree):
    tree.group().output(GREEN)
    tree.output(RED)


def without_a_link(tree):
    tree.output()
    tree.group().output(GREEN)


def without_a_link_inside(tree):
    tree.output(RED)
    tree.group().output()


def two_groups(tree):
    tree.group().output(BLUE)
    tree.group().output(GREEN)


def muted(tree):
    tree.group().output(GREEN)
    tree.tree.nodes[0].mute = True
    tree.output(RED)


BUILDS = [
    inside_alone,
    nested,
    before_the_group,
    behind_the_group,
    without_a_link,
    without_a_link_inside,
    two_groups,
    muted,
]


@pytest.mark.parametrize("kind", ["Material", "World"])
@pytest.mark.parametrize("build", BUILDS)
def test_the_output_of_a_group(scene, render, build, kind):
    if kind == "Material":
        square = scene_parts.add_square(scene, "Square", 4.0)
        owner = bpy.data.materials.new("Material")
        square.data.materials.append(owner)
    else:
        scene.world = owner = bpy.data.worlds.new("World")
    if not owner.use_nodes:
        owner.use_nodes = True
    owner.node_tree.nodes.clear()
    build(Tree(owner.node_tree, kind))
    scene_parts.add_camera(scene, ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = 4
    theirs, ours = render_both(scene, render)
    assert np.abs(theirs - ours).max() < 1e-4
    assert theirs.max() == 1.0 or build is without_a_link
