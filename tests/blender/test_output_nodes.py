# SPDX-License-Identifier: GPL-3.0-or-later
"""Output nodes inside of groups: which of several is taken, against Cycles in the same Blender."""

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import render_both

RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class Holder:
    """A tree of a material, world or light, or of a group in it."""

    def __init__(self, tree, kind):
        self.tree, self.kind = tree, kind

    def shines(self, color):
        node = self.tree.nodes.new("ShaderNodeEmission")
        node.inputs["Color"].default_value = (*color, 1.0)
        return node

    def add_output(self, shader=None, target="ALL"):
        output = self.tree.nodes.new(f"ShaderNodeOutput{self.kind}")
        output.target = target
        if shader is not None:
            self.tree.links.new(shader.outputs[0], output.inputs["Surface"])

    def show(self, color, target="ALL"):
        self.add_output(self.shines(color), target)

    def group(self, tree=None):
        node = self.tree.nodes.new("ShaderNodeGroup")
        node.node_tree = tree or bpy.data.node_groups.new("Group", "ShaderNodeTree")
        return Holder(node.node_tree, self.kind)


def inside_alone(top):
    top.group().show(GREEN)


def nested(top):
    top.group().group().show(GREEN)


def a_group_with_one_that_holds_one(top):
    group = top.group()
    group.show(GREEN)
    group.group().show(BLUE)


def a_group_that_holds_one_before_its_own(top):
    group = top.group()
    group.group().show(BLUE)
    group.show(GREEN)


def before_the_group(top):
    top.show(RED)
    top.group().show(GREEN)


def behind_the_group(top):
    top.group().show(GREEN)
    top.show(RED)


def without_a_link(top):
    top.add_output()
    top.group().show(GREEN)


def without_a_link_inside(top):
    top.show(RED)
    top.group().add_output()


def two_groups(top):
    top.group().show(BLUE)
    top.group().show(GREEN)


def two_groups_the_first_without_a_link(top):
    top.group().add_output()
    top.group().show(GREEN)


def a_group_twice(top):
    group = top.group()
    top.group(group.tree)
    group.show(GREEN)


def muted_group(top):
    top.group().show(GREEN)
    top.tree.nodes[0].mute = True
    top.show(RED)


def muted_shader(top):
    top.show(RED)
    group = top.group()
    shines = group.shines(GREEN)
    shines.mute = True
    group.add_output(shines)


def shader_that_cycles_has_not(top):
    top.show(RED)
    group = top.group()
    group.add_output(group.tree.nodes.new("ShaderNodeShaderToRGB"))


def own_for_all_group_for_cycles(top):
    top.show(RED)
    top.group().show(GREEN, "CYCLES")


def own_for_cycles_group_for_all(top):
    top.show(RED, "CYCLES")
    top.group().show(GREEN)


def own_for_eevee(top):
    top.show(RED, "EEVEE")
    top.group().show(GREEN)


def two_of_its_own(top):
    top.show(RED, "EEVEE")
    top.show(BLUE, "CYCLES")
    top.tree.nodes.active = top.tree.nodes[1]


BUILDS = [
    inside_alone,
    nested,
    a_group_with_one_that_holds_one,
    a_group_that_holds_one_before_its_own,
    before_the_group,
    behind_the_group,
    without_a_link,
    without_a_link_inside,
    two_groups,
    two_groups_the_first_without_a_link,
    a_group_twice,
    muted_group,
    muted_shader,
    shader_that_cycles_has_not,
    own_for_all_group_for_cycles,
    own_for_cycles_group_for_all,
    own_for_eevee,
    two_of_its_own,
]
# What Blender 5 takes is linked to nothing.
_DARK_SINCE_5 = {without_a_link, two_groups_the_first_without_a_link}


def shown_by(scene, kind):
    """The datablock of a kind that the picture shows alone."""
    if kind == "World":
        scene.world = bpy.data.worlds.new("World")
        return scene.world
    square = scene_parts.add_square(scene, "Square", 4.0)
    if kind == "Material":
        square.data.materials.append(bpy.data.materials.new("Material"))
        return square.data.materials[0]
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.0
    scene_parts.add_object(scene, "Sun", sun)
    return sun


@pytest.mark.parametrize("kind", ["Material", "World", "Light"])
@pytest.mark.parametrize("build", BUILDS)
def test_the_output_of_a_group(scene, render, build, kind):
    owner = shown_by(scene, kind)
    if not owner.use_nodes:
        owner.use_nodes = True
    owner.node_tree.nodes.clear()
    build(Holder(owner.node_tree, kind))
    scene_parts.add_camera(scene, ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = 4
    theirs, ours = render_both(scene, render)
    # One colour each but for rounding, as in test_light_path.py.
    assert np.abs(theirs - ours).max() < 1e-3
    is_dark = build in _DARK_SINCE_5 and bpy.app.version >= (5, 0, 0)
    assert (theirs.max() > 0.5) == (not is_dark)
