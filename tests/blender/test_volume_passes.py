# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of light where things and the world are filled, beside Cycles in the same Blender."""

import bpy
import numpy as np
import pytest
import scene_parts
from test_passes import LONG
from test_volumes import (
    blocks,
    channels_of_both,
    filled,
    orthographic,
    smoke_of_noise,
    smoke_over_a_floor,
    spot_in_fog,
    turned_cube,
)

PASSES = {  # name before Blender 5: since
    "VolumeDir": "Volume Direct",
    "VolumeInd": "Volume Indirect",
    "DiffDir": "Diffuse Direct",
    "DiffInd": "Diffuse Indirect",
    "DiffCol": "Diffuse Color",
    "Emit": "Emission",
    "Env": "Environment",
}


def light(channels):
    """{pass: blocks()}, light of lobes by their colour."""
    made = {short: blocks(channels, name if LONG else short) for short, name in PASSES.items()}
    for part in ("DiffDir", "DiffInd"):
        made[part] = made[part] * made["DiffCol"]
    return made


def compared(scene, render, samples=256, bounces=0, block=0.08):
    """Cycles' passes, when Granita's are as theirs: within 2 % of the picture's mean, and `block` of it by
    block: both engines' noise leaves .06."""
    layer = scene.view_layers[0]
    for name in ("diffuse_direct", "diffuse_indirect", "diffuse_color", "emit", "environment"):
        setattr(layer, f"use_pass_{name}", True)
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True
    channels = channels_of_both(scene, render, samples, bounces, in_volumes=bounces)
    theirs, ours = map(light, channels)
    level = blocks(channels[0]).mean(axis=(0, 1)).max()
    report = {}
    for name, expected in theirs.items():
        difference = ours[name] - expected
        report[name] = (
            float(np.abs(difference.mean(axis=(0, 1))).max() / level),
            float(np.sqrt((difference**2).mean(axis=(0, 1))).max() / level),
        )
    wrong = {name: (a, b) for name, (a, b) in report.items() if a > 0.02 or b > block}
    assert not wrong, report
    return {name: float(values.mean() / level) for name, values in theirs.items()}


@pytest.mark.parametrize("bounces", [0, 4])
def test_smoke_over_a_floor(scene, render, bounces):
    smoke_over_a_floor(scene, 1.5, 0.9, 2.0, (0.9, 0.9, 0.9, 1.0))
    there = compared(scene, render, bounces=bounces)
    assert there["VolumeDir"] > 0.05
    assert (there["VolumeInd"] > 0.05) == (bounces > 0)


@pytest.mark.parametrize("bounces", [0, 3])
def test_fog(scene, render, bounces):
    spot_in_fog(scene)
    there = compared(scene, render, bounces=bounces)
    assert there["VolumeDir"] > 0.05


@pytest.mark.parametrize("bounces", [0, 2])
def test_smoke_of_noise_that_glows_before_a_world(scene, render, bounces):
    tree = smoke_of_noise(turned_cube())
    tree.nodes["Principled Volume"].inputs["Emission Strength"].default_value = 0.2
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.4, 0.8, 1.0)
    orthographic(scene)
    there = compared(scene, render, bounces=bounces)
    assert min(there[name] for name in ("VolumeDir", "Emit", "Env")) > 0.05


def test_what_only_absorbs_dims_passes_of_surfaces(scene, render):
    bpy.ops.mesh.primitive_plane_add(size=12.0, location=(0, 0, -2))
    bpy.context.object.data.materials.append(scene_parts.emission("Glow", (0.25, 0.5, 0.75)))
    filled(turned_cube(), "ShaderNodeVolumeAbsorption", Color=(0.9, 0.4, 0.1, 1.0), Density=0.8)
    orthographic(scene)
    assert compared(scene, render, 16, block=0.02)["Emit"] > 0.1
