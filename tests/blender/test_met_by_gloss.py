# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps in mirrors and gloss, of things that some rays meet and others pass: rays of lobes look for lamps by their own
kind, not as shadow rays do."""

import bpy
import numpy as np
import pytest
import scene_parts
from bounced_parts import render_bounced, surface
from node_comparison import Tree


def wall(scene, roughness):
    """It faces a camera that sees nothing else; what is behind that one stands in for a room."""
    surface(
        scene_parts.add_square(scene, "Wall", 20.0),
        "ShaderNodeBsdfGlossy",
        (1.0, 1.0, 1.0),
        Roughness=roughness,
    )
    scene_parts.set_world(scene, (0.1, 0.1, 0.1))
    scene_parts.add_camera(scene, (0.0, 0.0, 2.0), ortho_scale=5.0)
    scene.render.resolution_x, scene.render.resolution_y = 32, 24


def shining_square(scene, height):
    square = scene_parts.add_square(scene, "Shining", 1.5, (0.0, 0.0, height))
    square.data.materials.append(scene_parts.emission("Shining", (1.0, 1.0, 1.0), 4.0))
    square.rotation_euler = (np.pi, 0.0, 0.0)
    return square


def lamp_over(scene, height):
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy, lamp.size = 100.0, 1.5
    return scene_parts.add_object(scene, "Lamp", lamp, (0.0, 0.0, height))


def agree(both):
    """Blocks of 4 x 4 pixels, of which those at borders hold a sixteenth of Granita's mirror images' borders."""
    theirs, ours = (image.reshape(6, 4, 8, 4, 3).mean(axis=(1, 3, 4)) for image in both)
    off = np.abs(ours - theirs) / (theirs + 0.1 * theirs.mean())
    assert np.median(off) < 0.02  # the noise of rough gloss, either's; mirrors have none
    assert (off > 0.06).mean() < 0.2
    assert both[1].mean() == pytest.approx(both[0].mean(), rel=0.01)


@pytest.mark.parametrize("shadow, glossy", [(True, False), (False, True)])
@pytest.mark.parametrize("kind, roughness", [("LAMP", 0.0), ("LAMP", 0.3), ("MESH", 0.0)])
def test_a_card_before_a_lamp_is_met_by_its_own_visibility(
    scene, render, kind, roughness, shadow, glossy
):
    """A mirror showed lamps through cards without shadow (22 times too bright) and none behind cards hidden from gloss
    (- 94 %); rough gloss shares the light as Cycles does (- 40, + 7 %)."""
    wall(scene, roughness)
    card = scene_parts.add_square(scene, "Card", 2.0, (0.0, 0.0, 4.0))
    surface(card, "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8))
    card.visible_shadow, card.visible_glossy = shadow, glossy
    lamp_over(scene, 6.0) if kind == "LAMP" else shining_square(scene, 6.0)
    agree(render_bounced(scene, render, 1024, limit=1))


def test_what_shines_and_casts_no_shadow_is_seen_once_in_a_mirror(scene, render):
    """Its far side shone through: twice as bright."""
    wall(scene, 0.0)
    bpy.ops.mesh.primitive_cube_add(size=1.5, location=(0.0, 0.0, 5.0), rotation=(0.4, 0.3, 0.0))
    cube = bpy.context.object
    cube.data.materials.append(scene_parts.emission("Shining", (1.0, 1.0, 1.0), 0.5))
    cube.visible_shadow = False
    agree(render_bounced(scene, render, 64, limit=1, samples=64))


def test_a_lamp_without_shadows_is_hidden_in_a_mirror(scene, render):
    """Its light passes all, but its picture does not."""
    wall(scene, 0.0)
    scene_parts.cast_no_shadow(lamp_over(scene, 6.0).data)
    card = scene_parts.add_square(scene, "Card", 1.0, (0.4, 0.2, 4.0))
    surface(card, "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8))
    agree(render_bounced(scene, render, 64, limit=1, samples=64))


@pytest.mark.parametrize("limit", [0, 3])
@pytest.mark.parametrize("roughness", [0.0, 0.3])
def test_a_window_that_is_clear_to_shadow_rays_alone(scene, render, roughness, limit):
    """As those are made whose panes would darken rooms: gloss saw lamps through the pane as if it were not there, and
    through the glass once more."""
    wall(scene, roughness)
    pane = scene_parts.add_square(scene, "Pane", 3.0, (0.0, 0.0, 4.0))
    tree = Tree(pane)
    mix, glass = tree.add("ShaderNodeMixShader"), tree.add("ShaderNodeBsdfRefraction")
    glass.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    glass.inputs["IOR"].default_value = 1.0
    tree.link(tree.add("ShaderNodeLightPath").outputs["Is Shadow Ray"], mix.inputs["Fac"])
    tree.link(glass.outputs[0], mix.inputs[1])
    tree.link(tree.add("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
    tree.link(mix.outputs[0], tree.output.inputs["Surface"])
    lamp_over(scene, 6.0)
    agree(render_bounced(scene, render, 256, limit=limit))
