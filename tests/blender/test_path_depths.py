# SPDX-License-Identifier: GPL-3.0-or-later
"""The depths of the node Light Path beyond the first bounce: each way counts its own, as in Cycles."""

import bpy
import pytest
import scene_parts
from bounced_parts import closure, met_by_chance, render_bounced, room, surface
from node_comparison import Tree, socket

KINDS = ["Ray Depth", "Diffuse Depth", "Glossy Depth", "Transmission Depth", "Transparent Depth"]


def shine_by(thing, name):
    """Sends out a tenth of what an output of Light Path says, beside half of what arrives, from diffuse and sharp lobes."""
    thing.data.materials.clear()
    tree = Tree(thing)
    depth, tenth = tree.add("ShaderNodeLightPath"), tree.add("ShaderNodeEmission")
    scale = tree.add("ShaderNodeMath", operation="MULTIPLY")
    scale.inputs[1].default_value = 0.1
    tree.link(socket(depth.outputs, name), scale.inputs[0])
    tree.link(scale.outputs[0], tenth.inputs["Strength"])
    mix, add = tree.add("ShaderNodeMixShader"), tree.add("ShaderNodeAddShader")
    for kind, slot in zip(("Diffuse", "Glossy"), mix.inputs[1:], strict=True):
        shader = closure(tree, f"ShaderNodeBsdf{kind}", (0.5, 0.5, 0.5), Roughness=0.0)
        tree.link(shader.outputs[0], slot)
    for shader, slot in zip((mix, tenth), add.inputs, strict=True):
        tree.link(shader.outputs[0], slot)
    tree.link(add.outputs[0], tree.output.inputs["Surface"])
    # Else Cycles mixes in what lamps' samples count, one less.
    met_by_chance(thing.data.materials[0])


@pytest.mark.parametrize("name", KINDS)
def test_each_way_counts_what_it_has_met(scene, render, name):
    """A room whose walls shine by what has been counted, and in it a ball of glass behind a veil: all depths ended at 1."""
    ball = room(scene)
    bpy.data.objects.remove(bpy.data.objects["Lamp"])
    for i in range(5):
        shine_by(bpy.data.objects[f"Wall {i}"], name)
    ball.data.materials.clear()
    surface(ball, "ShaderNodeBsdfRefraction", (0.9, 0.9, 0.9), Roughness=0.0, IOR=1.2)
    veil = scene_parts.add_square(scene, "Veil", 2.0, (0.0, 0.0, 0.4))
    veil.visible_camera = False
    surface(veil, "ShaderNodeBsdfTransparent", (0.9, 0.9, 0.9))
    theirs, ours = render_bounced(scene, render, 1024, limit=6, transmission_bounces=6, samples=256)
    assert theirs.mean() > 0.01
    # Two seeds of Transmission Depth, of glass alone, are 1.4 % apart here and .8 there.
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.015)


def test_a_mirror_in_a_mirror_is_deeper(scene, render):
    """Two mirrors at right angles: what both show is half of white where it counts two."""
    for i, turn in enumerate((0.785398, -0.785398)):
        mirror = scene_parts.add_square(scene, f"Mirror {i}", 4.0, (1.41421 * (i - 0.5), 0.0, 0.0))
        mirror.rotation_euler.y = turn
        surface(mirror, "ShaderNodeBsdfGlossy", (1.0, 1.0, 1.0), Roughness=0.0)
    screen = scene_parts.add_square(scene, "Screen", 20.0, (0.0, 0.0, 6.0))
    screen.visible_camera = False
    tree = Tree(screen)
    tree.emit(tree.add("ShaderNodeLightPath").outputs["Ray Depth"], 0.25)
    scene_parts.add_camera(scene, (0.0, 0.0, 5.0), ortho_scale=1.0)
    scene.render.resolution_x = scene.render.resolution_y = 8
    _, ours = render_bounced(scene, render, 16, limit=4)
    assert ours == pytest.approx(0.5)
