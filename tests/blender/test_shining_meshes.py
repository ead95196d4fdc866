# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that shine, beside Cycles in the same Blender: without a bounce, moving, instanced, before metal and in motion."""

import math

import bpy
import node_comparison
import numpy as np
import pytest
import scene_parts
from bounced_parts import render_bounced, room, surface


def shines(thing, strength, color=(1.0, 0.9, 0.7)):
    tree = node_comparison.Tree(thing)
    shader = tree.add("ShaderNodeEmission")
    shader.inputs["Color"].default_value = (*color, 1.0)
    shader.inputs["Strength"].default_value = strength
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    return thing


def dark_room(scene, **ball):
    """The room of the bounces' test without its lamp."""
    surface(room(scene), **ball)
    bpy.data.objects.remove(bpy.data.objects["Lamp"])


def panel(scene):
    shines(scene_parts.add_square(scene, "Panel", 0.5, (0.0, 0.95, 0.0)), 10.0).rotation_euler = (
        math.pi / 2,
        0,
        0,
    )


def screen(scene):
    """Checks of two colours, one of them dark, times bands, as wide as 24 pixels show of them on the ceiling."""
    thing = scene_parts.add_square(scene, "Screen", 0.8, (0.0, 0.95, 0.0))
    thing.rotation_euler = (math.pi / 2, 0, 0)
    tree = node_comparison.Tree(thing)
    shader, checks = tree.add("ShaderNodeEmission"), tree.add("ShaderNodeTexChecker")
    checks.inputs["Color1"].default_value = (1.0, 0.6, 0.1, 1.0)
    checks.inputs["Color2"].default_value = (0.0, 0.1, 0.5, 1.0)
    checks.inputs["Scale"].default_value = 2.0
    wave = tree.add("ShaderNodeTexWave")
    wave.inputs["Scale"].default_value = 0.5
    strength = tree.add("ShaderNodeMath")
    strength.operation = "MULTIPLY"
    strength.inputs[1].default_value = 12.0
    inside = tree.add("ShaderNodeVectorMath")  # and not on the border between two layers of checks
    inside.inputs[1].default_value = (0.0, 0.0, 0.1)
    tree.link(tree.add("ShaderNodeTexCoord").outputs["Generated"], inside.inputs[0])
    tree.link(inside.outputs[0], checks.inputs["Vector"])
    tree.link(wave.outputs["Color"], strength.inputs[0])
    tree.link(checks.outputs["Color"], shader.inputs["Color"])
    tree.link(strength.outputs[0], shader.inputs["Strength"])
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])


def bulbs(scene):
    """Four instances of one ball of 80 faces, one of which goes down while the shutter is open."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.08)
    first = shines(bpy.context.object, 30.0)
    for i, place in enumerate(
        [(-0.5, 0.6, 0.0), (0.0, 0.6, 0.4), (0.5, 0.6, 0.0), (0.0, 0.6, -0.4)]
    ):
        bulb = first if i == 0 else bpy.data.objects.new(f"Bulb {i}", first.data)
        if i:
            scene.collection.objects.link(bulb)
        bulb.location = place
    for frame, height in ((0, 0.9), (1, 0.6), (2, 0.3)):
        first.location.y = height
        first.keyframe_insert("location", index=1, frame=frame)
    scene_parts.make_linear(first)
    scene.render.use_motion_blur = True
    scene.frame_set(1)


LAMPS = {"panel": panel, "screen": screen, "bulbs": bulbs}


@pytest.mark.parametrize("lamps", LAMPS)
@pytest.mark.parametrize("rough", [None, 0.3])
@pytest.mark.parametrize("bounces", ["NONE", "FULL"])
def test_a_room_is_as_bright_as_in_cycles(scene, render, lamps, rough, bounces):
    """Cycles' 512 samples leave up to 2 % of noise in the mean of a colour where small bulbs are lamps."""
    scene.cycles.caustics_reflective = True
    if rough is None:
        dark_room(scene, kind="ShaderNodeBsdfDiffuse", color=(0.7, 0.7, 0.7))
    else:
        dark_room(scene, kind="ShaderNodeBsdfGlossy", color=(0.7, 0.7, 0.7), Roughness=rough)
    LAMPS[lamps](scene)
    theirs, ours = render_bounced(scene, render, 512, bounces=bounces)
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.03)
    # Blocks of 4 x 4 pixels, but for those where what shines itself is seen.  .03 to .05 were seen, Cycles' noise.
    blocks = [p.reshape(6, 4, 6, 4, 3).swapaxes(1, 2).reshape(36, 16, 3) for p in (theirs, ours)]
    dim = np.maximum(*blocks).max(axis=(1, 2)) < 0.8
    theirs, ours = (block.mean(axis=1)[dim] for block in blocks)
    assert dim.sum() >= 18
    assert np.sqrt(np.mean((theirs - ours) ** 2)) < 0.07 * theirs.mean()
