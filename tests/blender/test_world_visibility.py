# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray Visibility of a world, which Cycles' add-on brings: a diffuse and a mirroring square, a rough one and the
world itself side by side, beside Cycles in the same Blender."""

import bpy
import node_comparison
import numpy as np
import pytest
import scene_parts

SURFACES = [
    ("ShaderNodeBsdfDiffuse", None),
    ("ShaderNodeBsdfGlossy", 0.0),
    ("ShaderNodeBsdfGlossy", 0.5),
]


def strips(scene, surfaces=SURFACES):
    for i, (kind, roughness) in enumerate(surfaces):
        thing = scene_parts.add_square(scene, f"Strip {i}", 1.0, (i - 1.5, 0.0, 0.0))
        tree = node_comparison.Tree(thing)
        shader = tree.add(kind if hasattr(bpy.types, kind) else "ShaderNodeBsdfAnisotropic")
        shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        if roughness is not None:
            shader.inputs["Roughness"].default_value = roughness
        tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    scene_parts.add_camera(scene, ortho_scale=4.0)
    scene.render.resolution_x, scene.render.resolution_y = 16, 4


def sky(scene, varies):
    scene.world = bpy.data.worlds.new("Sky")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    background = next(n for n in nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.25, 0.5, 1.0, 1.0)
    if varies:
        color = nodes.new("ShaderNodeVectorMath")
        color.operation = "MULTIPLY_ADD"
        color.inputs[1].default_value = color.inputs[2].default_value = (0.5, 0.5, 0.5)
        links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], color.inputs[0])
        links.new(color.outputs[0], background.inputs["Color"])


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("hidden", ["camera", "diffuse", "glossy"])
def test_rays_see_the_world_or_not(scene, render, hidden, transparent):
    strips(scene, SURFACES[:2])
    sky(scene, varies=False)
    scene.render.film_transparent = transparent
    setattr(scene.world.cycles_visibility, hidden, False)
    theirs, ours = node_comparison.render_both(scene, render, channels="RGBA")
    # A constant world on a plane has no noise in either, but for a rough gloss.
    assert np.abs(theirs - ours).max() < 1e-3


@pytest.mark.parametrize("hidden", ["diffuse", "glossy", "transmission"])
@pytest.mark.parametrize("bounces", ["NONE", "FULL"])
def test_translucent_sees_what_neither_kind_is_shut_out_of(scene, render, hidden, bounces):
    """Its rays are diffuse and transmitted at once."""
    strips(scene, [("ShaderNodeBsdfTranslucent", None)] * 4)
    sky(scene, varies=False)
    setattr(scene.world.cycles_visibility, hidden, False)
    scene.granita.bounces = bounces
    theirs, ours = node_comparison.render_both(scene, render, 256)
    assert (theirs.max() > 0.2) == (hidden == "glossy")
    # The mean of 64 pixels: Cycles' have noise.
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.01)


@pytest.mark.parametrize("hidden", ["camera", "diffuse", "glossy"])
def test_a_world_that_varies_is_hidden_too(scene, render, hidden):
    strips(scene)
    sky(scene, varies=True)
    setattr(scene.world.cycles_visibility, hidden, False)
    theirs, ours = node_comparison.render_both(scene, render, samples=64)
    by_strip = (picture.reshape(4, 4, 4, 3).mean(axis=(0, 2, 3)) for picture in (theirs, ours))
    # 1,024 samples a strip of a world from 0 to 1: .29 / 32 of noise at most, four times.
    assert np.abs(np.subtract(*by_strip)).max() < 0.036
    black = {"camera": 3, "diffuse": 0, "glossy": slice(1, 3)}[hidden]
    assert not ours[:, np.r_[0:16].reshape(4, 4)[black].ravel()].any()


@pytest.mark.parametrize("hidden", [None, "diffuse", "shadow"])
def test_a_card_hides_a_constant_world_from_the_rays_that_meet_it(scene, render, hidden):
    """No lamp sends this light: rays of diffuse lobes find it, so that what casts a shadow alone casts none."""
    scene_parts.add_square(scene, "Floor", 50.0, (0.0, 0.0, 0.0))
    card = scene_parts.add_square(scene, "Card", 2.0, (0.0, 0.0, 1.0))
    card.visible_camera = False
    if hidden:
        setattr(card, f"visible_{hidden}", False)
    for thing, color in ((scene.objects["Floor"], 0.8), (card, 0.0)):
        tree = node_comparison.Tree(thing)
        shader = tree.add("ShaderNodeBsdfDiffuse")
        shader.inputs["Color"].default_value = (color, color, color, 1.0)
        tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    sky(scene, varies=False)
    scene_parts.add_camera(scene, ortho_scale=2.0)
    scene.render.resolution_x, scene.render.resolution_y = 8, 8
    theirs, ours = node_comparison.render_both(scene, render, samples=256)
    # 16,384 samples of .5 to 1 of the world, in either: 1 % is three times their noise.
    assert np.abs(theirs.mean((0, 1)) / ours.mean((0, 1)) - 1).max() < 0.01
