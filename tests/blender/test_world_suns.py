# SPDX-License-Identifier: GPL-3.0-or-later
"""Suns that nodes draw into a world: narrower than what the world is baked at."""

import bpy
import numpy as np
import pytest
import scene_parts
from node_comparison import Tree, render_both


def sun_by_nodes(scene, degrees, direction):
    """A disc of `degrees` across in a black world, as bright as makes its irradiance pi."""
    half = np.radians(degrees) / 2
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    apart, length = nodes.new("ShaderNodeVectorMath"), nodes.new("ShaderNodeVectorMath")
    apart.operation, length.operation = "ADD", "LENGTH"
    apart.inputs[1].default_value = direction
    inside, strength = nodes.new("ShaderNodeMath"), nodes.new("ShaderNodeMath")
    inside.operation, strength.operation = "LESS_THAN", "MULTIPLY"
    inside.inputs[1].default_value = 2 * np.sin(half / 2)
    strength.inputs[1].default_value = 1.0 / np.sin(half) ** 2
    background = next(node for node in nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Incoming"], apart.inputs[0])
    links.new(apart.outputs[0], length.inputs[0])
    links.new(length.outputs["Value"], inside.inputs[0])
    links.new(inside.outputs[0], strength.inputs[0])
    links.new(strength.outputs[0], background.inputs["Strength"])


@pytest.mark.parametrize("degrees", [0.17, 0.53])
def test_a_small_sun_in_a_black_world_lights(scene, render, degrees):
    """Irradiance pi times the cosine, .8, off a white plane.  (Cycles of 3.4: .50 and .75.)"""
    sun_by_nodes(scene, degrees, (0.0, 0.6, 0.8))
    tree = Tree(scene_parts.add_square(scene))
    diffuse = tree.add("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    tree.link(diffuse.outputs[0], tree.output.inputs["Surface"])
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x = scene.render.resolution_y = 24
    scene.granita.light_samples = 256
    _, ours = render_both(scene, render)
    # What lies in texels whose places missed the disc is sampled a hundred times less often: of 150,000 samples
    # some 50 stand for a twentieth of the light.
    assert abs(ours.mean() - 0.8) < 0.02 * 0.8
