# SPDX-License-Identifier: GPL-3.0-or-later
"""The node Light Path tells what asks: the camera, a shadow, or light of the world on a lobe; the truth
is Cycles without bounces, or with one through a surface.  A constant world on a plane has no noise in either, but
where it is roughly refracted."""

import bpy
import numpy as np
import pytest
import scene_parts
from bounced_parts import render_bounced
from node_comparison import Tree, render_both, socket

OUTPUTS = [
    "Is Camera Ray",
    "Is Shadow Ray",
    "Is Diffuse Ray",
    "Is Glossy Ray",
    "Is Singular Ray",
    "Is Reflection Ray",
    "Is Transmission Ray",
    "Ray Depth",
    "Diffuse Depth",
    "Glossy Depth",
    "Transmission Depth",
]


def path(nodes, name):
    return socket(nodes.new("ShaderNodeLightPath").outputs, name)


def world_by(scene, name):
    """A world that an output of Light Path, which is at most 3, mixes of two colours."""
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    mix = nodes.new("ShaderNodeMixRGB")
    mix.inputs[1].default_value = (1.0, 0.5, 0.125, 1.0)
    mix.inputs[2].default_value = (0.0, 0.25, 0.5, 1.0)
    third = nodes.new("ShaderNodeMath")
    third.operation = "DIVIDE"
    third.inputs[1].default_value = 3.0
    links.new(path(nodes, name), third.inputs[0])
    links.new(third.outputs[0], mix.inputs[0])
    background = next(n for n in nodes if n.type == "BACKGROUND")
    links.new(mix.outputs[0], background.inputs["Color"])


def strips(scene, kinds):
    """Side by side, a square for each (kind, roughness), three at most; the world where there are fewer."""
    for i, (kind, roughness) in enumerate(kinds):
        thing = scene_parts.add_square(scene, kind, 1.0, (i - 1.0, 0.0, 0.0))
        tree = Tree(thing)
        kind = f"ShaderNodeBsdf{kind}"
        shader = tree.add(kind if hasattr(bpy.types, kind) else "ShaderNodeBsdfAnisotropic")
        shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        if "Roughness" in shader.inputs:
            shader.inputs["Roughness"].default_value = roughness
        tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    scene_parts.add_camera(scene, ortho_scale=3.0)
    scene.render.resolution_x, scene.render.resolution_y = 12, 4


@pytest.mark.parametrize("name", OUTPUTS)
def test_the_world_knows_who_asks(scene, render, name):
    strips(scene, [("Diffuse", 0.0), ("Glossy", 0.0)])
    world_by(scene, name)
    theirs, ours = render_both(scene, render)
    # One colour each but for rounding: Cycles packs normals and keeps lights in single precision.
    assert np.abs(theirs - ours).max() < 1e-3


@pytest.mark.parametrize("name", OUTPUTS)
def test_the_world_knows_who_asks_through_a_surface(scene, render, name):
    """What is refracted counts as glossy, too, but for its depth."""
    strips(scene, [("Refraction", 0.0), ("Refraction", 0.3), ("Translucent", 0.0)])
    world_by(scene, name)
    theirs, ours = render_bounced(scene, render, 64, limit=1)
    # Of some pixels one sample of 64 is lost; of rough refraction more, at facets: .012 of the mean.
    assert np.abs(theirs - ours).mean(axis=0).max() < 0.02


def shadow_scene(scene, build):
    """A sheet 3 m over a floor under a slanted sun; `build(tree)` makes the sheet's shader.  The camera sees
    its shadow alone."""
    floor = scene_parts.add_square(scene, "Floor", 8.0)
    tree = Tree(floor, "Floor")
    diffuse = tree.add("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    tree.link(diffuse.outputs[0], tree.output.inputs["Surface"])
    sheet = scene_parts.add_square(scene, "Sheet", 2.0, (3.0, 0.0, 3.0))
    tree = Tree(sheet, "Sheet")
    build(tree)
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = np.pi, 0.0
    sun = scene_parts.add_object(scene, "Sun", light)
    sun.rotation_euler = (0.0, np.pi / 4, 0.0)
    scene_parts.add_camera(scene, (0.0, 0.0, 5.0), ortho_scale=4.0)
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.cycles.transparent_max_bounces = 8


def let_through(tree, factor, color=None):
    """Transparent where `factor`, else black."""
    mix, clear = tree.add("ShaderNodeMixShader"), tree.add("ShaderNodeBsdfTransparent")
    black = tree.add("ShaderNodeBsdfDiffuse")
    black.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    if color is not None:
        tree.link(color, clear.inputs["Color"])
    tree.link(factor, mix.inputs[0])
    tree.link(black.outputs[0], mix.inputs[1])
    tree.link(clear.outputs[0], mix.inputs[2])
    tree.link(mix.outputs[0], tree.output.inputs["Surface"])


def check(theirs, ours):
    """Rows through the middle of the shadow and beside it: along its edge shading is interpolated."""
    rows = [0, 3, 4, 7]
    assert np.abs(theirs[rows] - ours[rows]).max() < 1e-3


@pytest.mark.parametrize("name", ["Is Shadow Ray", "Is Camera Ray", "Is Diffuse Ray", "Ray Depth"])
def test_shadows_know_that_they_are(scene, render, name):
    shadow_scene(scene, lambda tree: let_through(tree, path(tree.nodes, name)))
    theirs, ours = render_both(scene, render)
    check(theirs, ours)


def test_the_length_of_a_shadow_ray(scene, render):
    """It is that from the floor to the sheet, not from the camera."""

    def build(tree):
        length = tree.add("ShaderNodeMath", operation="MULTIPLY")
        tree.link(path(tree.nodes, "Ray Length"), length.inputs[0])
        length.inputs[1].default_value = 0.1
        let_through(tree, path(tree.nodes, "Is Shadow Ray"), length.outputs[0])

    shadow_scene(scene, build)
    theirs, ours = render_both(scene, render)
    assert abs(theirs.min() - 0.3) < 0.01  # 3 m up at 45 degrees: 4.24 m; the sun's cosine: .707
    check(theirs, ours)


@pytest.mark.parametrize("kind", ["ORTHO", "PERSP"])
def test_the_length_of_a_camera_ray(scene, render, kind):
    """From its near clip plane, whatever the lens."""
    floor = scene_parts.add_square(scene, size=12.0)
    floor.rotation_euler.x = 0.7
    camera = scene_parts.add_camera(scene, (0.3, 0, 5), ortho_scale=3.0)
    camera.data.type, camera.data.clip_start = kind, 1.5
    scene.render.resolution_x = scene.render.resolution_y = 16
    tree = Tree(floor)
    tree.emit(path(tree.nodes, "Ray Length"), 0.1)
    theirs, ours = render_both(scene, render, samples=16)
    assert 0.1 < theirs.min() < theirs.max() - 0.1
    # Where in a pixel 16 samples lie is by chance in both: a quarter of the slope across one.
    assert np.abs(theirs - ours).max() < 0.005
    assert theirs.mean() == pytest.approx(ours.mean(), rel=0.001)


@pytest.mark.parametrize("invisible", [True, False])
def test_a_thing_for_the_camera_or_for_shadows_alone(scene, render, invisible):
    """Seen by the camera in front of a floor; the sun's shadow of it falls beside."""

    def build(tree):
        let_through(tree, path(tree.nodes, "Is Camera Ray" if invisible else "Is Shadow Ray"))

    shadow_scene(scene, build)
    bpy.data.objects["Sheet"].location.x = 1.0
    theirs, ours = render_both(scene, render)
    assert theirs.std() > 0.1
    check(theirs, ours)
