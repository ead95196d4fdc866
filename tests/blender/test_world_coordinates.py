# SPDX-License-Identifier: GPL-3.0-or-later
"""What Texture Coordinate and Geometry hold in a world, beside Cycles in the same Blender."""

import bpy
import node_comparison
import numpy as np
import pytest
import scene_parts

OUTPUTS = [
    ("ShaderNodeTexCoord", "Generated"),
    ("ShaderNodeTexCoord", "Normal"),
    ("ShaderNodeTexCoord", "Object"),
    ("ShaderNodeTexCoord", "Reflection"),
    ("ShaderNodeNewGeometry", "Position"),
    ("ShaderNodeNewGeometry", "Normal"),
    ("ShaderNodeNewGeometry", "Incoming"),
]


def world_tree(scene):
    """(tree, the vector that it shows)"""
    camera = scene_parts.add_camera(scene)
    camera.data.type, camera.data.lens = "PERSP", 18.0
    camera.rotation_euler = (0.7, 0.2, 0.4)
    scene.render.resolution_x = scene.render.resolution_y = 16
    world = scene.world = bpy.data.worlds.new("World")
    if world.node_tree is None:
        world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    shown = nodes.new("ShaderNodeVectorMath")
    shown.operation = "MULTIPLY_ADD"
    shown.inputs[1].default_value = shown.inputs[2].default_value = (0.5, 0.5, 0.5)
    background = next(n for n in nodes if n.type == "BACKGROUND")
    links.new(shown.outputs[0], background.inputs["Color"])
    return world.node_tree, shown.inputs[0]


def expect_alike(scene, render):
    theirs, ours = node_comparison.render_both(scene, render, samples=64)
    # A pixel spans up to .06 of a unit of these; its mean of 64 samples is 1/64 of that off.
    assert np.abs(theirs - ours).max() < 0.004


@pytest.mark.parametrize("node, output", OUTPUTS)
def test_places_and_directions(scene, render, node, output):
    tree, shown = world_tree(scene)
    tree.links.new(tree.nodes.new(node).outputs[output], shown)
    expect_alike(scene, render)


@pytest.mark.parametrize("output", ["Window", "Camera", "Generated"])
def test_parallel_rays_have_one_direction_and_places_of_their_own(scene, render, output):
    tree, shown = world_tree(scene)
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 3.0
    scene.camera.data.shift_x = 0.1
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs[output], shown)
    expect_alike(scene, render)


def test_an_image_in_one_direction_is_not_filtered(scene, render):
    """A checker of texels of 6 degrees, of which parallel rays see a place between two."""
    tree, shown = world_tree(scene)
    scene.camera.data.type = "ORTHO"
    image = bpy.data.images.new("Checks", 64, 32, float_buffer=True)
    rows, columns = np.mgrid[0:32, 0:64]
    checks = np.ones((32, 64, 4), np.float32)
    checks[..., :3] = ((rows + columns) % 2)[..., None]
    image.pixels.foreach_set(checks.ravel())
    image.update()
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = image
    tree.links.new(node.outputs[0], shown)
    expect_alike(scene, render)


@pytest.mark.parametrize("kind", ["POINT", "VECTOR", "NORMAL"])
@pytest.mark.parametrize("convert_from", ["WORLD", "OBJECT", "CAMERA"])
@pytest.mark.parametrize("convert_to", ["WORLD", "OBJECT", "CAMERA"])
def test_transforms(scene, render, kind, convert_from, convert_to):
    """A world is no object: its own space is the world's."""
    tree, shown = world_tree(scene)
    turn = tree.nodes.new("ShaderNodeVectorTransform")
    turn.vector_type, turn.convert_from, turn.convert_to = kind, convert_from, convert_to
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], turn.inputs["Vector"])
    tree.links.new(turn.outputs[0], shown)
    expect_alike(scene, render)
