# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and worlds whose values are no numbers at some points spoil no other, and are named."""

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import Tree, render_both


def not_a_number(tree, infinite=False):
    """exp(500), or what that is less itself; of the position, so that it is not folded away."""
    length = tree.add("ShaderNodeVectorMath", operation="LENGTH")
    tree.link(tree.add("ShaderNodeNewGeometry").outputs["Position"], length.inputs[0])
    large = tree.add("ShaderNodeMath", operation="ADD")
    large.inputs[1].default_value = 500.0
    tree.link(length.outputs["Value"], large.inputs[0])
    huge = tree.add("ShaderNodeMath", operation="EXPONENT")
    tree.link(large.outputs[0], huge.inputs[0])
    if infinite:
        return huge.outputs[0]
    rest = tree.add("ShaderNodeMath", operation="SUBTRACT")
    for target in rest.inputs[:2]:
        tree.link(huge.outputs[0], target)
    return rest.outputs[0]


def infinite_emission(tree, glow):
    tree.link(not_a_number(tree, infinite=True), glow.inputs["Strength"])
    return glow


def broken_factor(tree, glow):
    mix = beside(tree, glow, "ShaderNodeMixShader", "ShaderNodeBsdfTransparent")
    tree.link(not_a_number(tree), mix.inputs[0])
    return mix


def broken_lobe(tree, glow):
    return beside(tree, glow, "ShaderNodeAddShader", "ShaderNodeBsdfDiffuse", broken=True)


def broken_transparency(tree, glow):
    return beside(tree, glow, "ShaderNodeMixShader", "ShaderNodeBsdfTransparent", broken=True)


def beside(tree, glow, sum_of_both, other, broken=False):
    """The node that joins what glows to another shader; broken: of a colour that is no number."""
    joined, shader = tree.add(sum_of_both), tree.add(other)
    if broken:
        tree.link(not_a_number(tree), shader.inputs["Color"])
    first, second = (target for target in joined.inputs if target.type == "SHADER")
    tree.link(glow.outputs[0], first)
    tree.link(shader.outputs[0], second)
    return joined


@pytest.mark.parametrize(
    "build", [infinite_emission, broken_factor, broken_lobe, broken_transparency]
)
def test_values_that_are_no_numbers(scene, render, build):
    wall = scene_parts.emission("Wall", (0.5, 0.5, 0.5))
    scene_parts.add_square(scene, "Wall", 2.0, (0.0, 0.0, -1.0), wall)
    tree = Tree(scene_parts.add_square(scene, "Bad", 1.0), "Bad")
    glow = tree.add("ShaderNodeEmission")
    glow.inputs["Color"].default_value = (0.25, 0.25, 0.25, 1.0)
    tree.link(build(tree, glow).outputs[0], tree.output.inputs["Surface"])
    scene_parts.add_object(scene, "Sun", bpy.data.lights.new("Sun", "SUN"))
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 20
    theirs, ours = render_both(scene, render)
    assert np.isfinite(ours).all()
    assert np.abs(theirs - ours).max() < 1e-5


@pytest.mark.parametrize("lights", [False, True])
def test_worlds_that_are_no_numbers_are_black(scene, render, capfd, lights):
    world = scene.world = bpy.data.worlds.new("Bad")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = float("nan")
    for ray in ("diffuse", "glossy", "transmission", "scatter"):
        setattr(world.cycles_visibility, ray, lights)
    wall = scene_parts.emission("Wall", (0.5, 0.5, 0.5))
    scene_parts.add_square(scene, "Wall", 1.0, (0.0, 0.0, -1.0), wall)
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 20
    found = render(scene)["ViewLayer.Combined.R"]
    assert "world 'Bad': is not finite" in capfd.readouterr().out
    assert np.abs(found[8:12, 8:12] - 0.5).max() < 1e-6
    assert (found[[0, 0, -1, -1], [0, -1, 0, -1]] == 0.0).all()
