# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that goes from hair to hair, against Cycles of the same Blender."""

import pytest
import scene_parts
from bounced_parts import render_bounced
from hair_parts import furry
from node_comparison import Tree


@pytest.mark.parametrize("kind", ["Reflection", "Transmission", "Principled"])
def test_dense_hair_is_as_bright(scene, render, kind):
    """Lit by a white sky, over two hairs more: Reflection was 13 % too dark, as rays took hair for strips that face them, all
    along x, which hid half of the world from what they met."""
    thing = furry(
        scene, 900, root_radius=0.05, tip_radius=0.02, hair_length=0.6, brownian_factor=0.2
    )
    thing.show_instancer_for_render = False
    tree = Tree(thing)
    if kind == "Principled":
        shader = tree.add("ShaderNodeBsdfHairPrincipled", parametrization="COLOR")
        shader.inputs["Color"].default_value = (0.8, 0.5, 0.3, 1.0)
    else:
        shader = tree.add("ShaderNodeBsdfHair", component=kind)
        shader.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1.0)
        shader.inputs["RoughnessU"].default_value = shader.inputs["RoughnessV"].default_value = 0.3
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    scene_parts.set_world(scene, (1.0, 1.0, 1.0))
    scene.cycles_curves.shape = "RIBBONS"
    scene.render.film_transparent = True
    camera = scene_parts.add_camera(scene, (0.0, -4.0, 2.0))
    camera.rotation_euler.x = 1.15
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    theirs, ours = render_bounced(scene, render, 128, limit=2, samples=64)
    assert ours.mean(axis=(0, 1)) == pytest.approx(theirs.mean(axis=(0, 1)), rel=0.02)
