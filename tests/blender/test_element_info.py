# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair Info (Curves Info) and Point Info against Cycles, as emission.

Means over blocks of 8 by 8 pixels: each engine has its own samples of the edges of ribbons.
"""

import bpy
import numpy as np
import pytest
import scene_parts
from hair_parts import curve_through, furry, grid_points
from node_comparison import Tree, render_both, rmse
from test_bsdfs import give_material

PIXELS, BLOCK = 64, 8
# Relative to the deviation of the blocks: what edges make of 64 samples.
LIMIT = 0.03


def compare(scene, render):
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    if hasattr(scene, "cycles_curves"):
        scene.cycles_curves.shape = "RIBBONS"
    count = PIXELS // BLOCK
    theirs, ours = (
        picture.reshape(count, BLOCK, count, BLOCK, 3).mean(axis=(1, 3))
        for picture in render_both(scene, render, samples=64)
    )
    assert theirs.std() > 0.02
    assert rmse(theirs, ours) < LIMIT * theirs.std()


def glow(tree, kind, output, scale):
    """Shows an output, times a number."""
    info = tree.add(kind)
    scaled = tree.add("ShaderNodeVectorMath", operation="MULTIPLY")
    tree.link(info.outputs[output], scaled.inputs[0])
    scaled.inputs[1].default_value = (scale,) * 3
    tree.emit(scaled.outputs[0])


HAIR = {"Is Strand": 1.0, "Intercept": 1.0, "Length": 0.8, "Thickness": 5.0, "Random": 1.0}


@pytest.mark.parametrize("output", HAIR)
def test_hair_of_particles(scene, render, output):
    thing = furry(scene, count=25, length_random=0.7, use_close_tip=False)
    glow(Tree(thing), "ShaderNodeHairInfo", output, HAIR[output])
    scene_parts.add_camera(scene, (0, -5, 1), ortho_scale=3.0).rotation_euler.x = 1.3
    compare(scene, render)


OF_CURVES = [("ShaderNodeHairInfo", output) for output in [*HAIR, "Tangent Normal"]]


@pytest.mark.parametrize(("kind", "output"), [*OF_CURVES, ("ShaderNodeNewGeometry", "Tangent")])
def test_curves(scene, render, kind, output):
    for place in range(4):
        x = -0.75 + 0.5 * place
        path = [(x, y, 0.3 * np.sin(2 * y + place)) for y in np.linspace(-1.1, place / 3, 9)]
        thing = curve_through(scene, path, 0.05 + 0.04 * place, f"Tube {place}")
        tree = Tree(thing, f"Tube {place}")
        glow(tree, kind, output, HAIR.get(output, 1.0))
        give_material(thing, tree.material)
    scene_parts.add_camera(scene, (0, -3, 3), ortho_scale=2.4).rotation_euler.x = 0.7
    compare(scene, render)


@pytest.mark.parametrize("output", ["Position", "Radius", "Random"])
def test_points(scene, render, output):
    thing = grid_points(scene, radius=0.3)
    thing.scale = (0.7, 0.7, 0.7)
    thing.location = (0.2, 0.3, 0.4)
    tree = Tree(thing)
    glow(tree, "ShaderNodePointInfo", output, 4.0 if output == "Radius" else 1.0)
    give_material(thing, tree.material)
    scene_parts.add_camera(scene, (0, 0, 8), ortho_scale=5.0)
    compare(scene, render)


def test_faces_have_neither(scene, render):
    thing = scene_parts.add_square(scene)
    tree = Tree(thing)
    hair, point = tree.add("ShaderNodeHairInfo"), tree.add("ShaderNodePointInfo")
    total = tree.add("ShaderNodeMath", operation="ADD")
    tree.link(hair.outputs["Random"], total.inputs[0])
    tree.link(point.outputs["Radius"], total.inputs[1])
    tree.emit(total.outputs[0])
    scene_parts.add_camera(scene, ortho_scale=1.0)
    theirs, ours = render_both(scene, render)
    assert not theirs.any()
    assert not ours.any()
    assert bpy.data.materials[tree.material.name]
