# SPDX-License-Identifier: GPL-3.0-or-later
"""Principled's Thin Wall, against Cycles of the same Blender."""

import bpy
import numpy as np
import pytest
import scene_parts
from bounced_parts import render_bounced

pytestmark = pytest.mark.skipif(
    bpy.app.version < (5, 2), reason="bodies have no thin walls before Blender 5.2"
)

TINT = (0.9, 0.6, 0.3, 1.0)


@pytest.fixture
def pane(scene):
    """A pane that leans by half a right angle, before a wall of two colours, a grey sky all around."""
    made = scene_parts.closure(
        "Pane", "ShaderNodeBsdfPrincipled", **{"Base Color": TINT, "Thin Wall": True}
    )
    square = scene_parts.add_square(scene, "Pane", 2.0, (0.0, 0.0, 0.5), made)
    square.rotation_euler = (0.0, 0.785, 0.0)
    for place, color in ((-1.5, (2.0, 1.0, 0.5)), (1.5, (0.1, 0.4, 0.8))):
        wall = scene_parts.emission(f"Wall {place}", color)
        scene_parts.add_square(scene, f"Wall {place}", 3.0, (place, 0.0, -2.0), wall)
    scene_parts.set_world(scene, (0.4, 0.4, 0.4))
    scene_parts.add_camera(scene, ortho_scale=2.4)
    scene.render.resolution_x = scene.render.resolution_y = 32
    return next(n for n in made.node_tree.nodes if n.type == "BSDF_PRINCIPLED")


@pytest.mark.parametrize("roughness", [0.0, 0.3, 0.7])
@pytest.mark.parametrize("ior", [1.5, 2.0])
def test_panes(scene, render, pane, roughness, ior):
    pane.inputs["Transmission Weight"].default_value = 1.0
    pane.inputs["Roughness"].default_value = roughness
    pane.inputs["IOR"].default_value = ior
    compare(scene, render, 256)


@pytest.mark.parametrize("anisotropy", [-0.8, 0.0, 0.8])
def test_leaves(scene, render, pane, anisotropy):
    pane.inputs["Subsurface Weight"].default_value = 0.8
    pane.inputs["Subsurface Anisotropy"].default_value = anisotropy
    pane.inputs["Specular IOR Level"].default_value = 0.2
    compare(scene, render, 256)


@pytest.mark.parametrize("roughness", [0.0, 0.5])
def test_lamps_behind_panes(scene, render, pane, roughness):
    """On a floor behind it, and through it: a smooth one is no glass to see lamps in, but clear."""
    pane.inputs["Transmission Weight"].default_value = 1.0
    pane.inputs["Roughness"].default_value = roughness
    floor = scene_parts.add_square(scene, "Floor", 6.0, (0.0, 0.0, -1.0), scene_parts.matte())
    floor.data.materials[0].use_nodes = True
    for place in ((0.6, 0.0, 4.0), (0.2, 0.3, -0.6)):
        lamp = bpy.data.lights.new("Lamp", "AREA")
        lamp.energy, lamp.size = 20.0, 0.6
        thing = scene_parts.add_object(scene, "Lamp", lamp, place)
        thing.rotation_euler = (0.0 if place[2] > 0.0 else 3.1416, 0.0, 0.0)
        thing.visible_transmission = roughness > 0.0
    scene_parts.set_world(scene, (0.0, 0.0, 0.0))
    # Cycles' noise: what the floor sends to the pane's other side.
    compare(scene, render, 1024, worst=0.15, mean=0.015)


def compare(scene, render, samples, worst=0.05, mean=0.01):
    """Blocks of 4 x 4 pixels."""
    theirs, ours = (
        picture.reshape(8, 4, 8, 4, 3).mean(axis=(1, 3))
        for picture in render_bounced(scene, render, samples, samples=64, limit=4)
    )
    assert theirs.std() > 0.2 * theirs.mean()
    assert np.abs(ours - theirs).max() < worst * theirs.max()
    np.testing.assert_allclose(ours.mean(axis=(0, 1)), theirs.mean(axis=(0, 1)), rtol=mean)


def test_one_that_varies_is_named(scene, render, pane, capfd):
    pane.inputs["Transmission Weight"].default_value = 1.0
    tree = pane.id_data
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(geometry.outputs["Backfacing"], pane.inputs["Thin Wall"])
    render(scene)
    assert "a Thin Wall that varies is not supported" in capfd.readouterr().out
