# SPDX-License-Identifier: GPL-3.0-or-later
"""Object Info's Random is the same number in Cycles, for objects and for instances."""

import bpy
import export_probe
import pytest
import scene_parts


def random_as_color(name):
    """A material that emits Object Info's Random."""
    material, nodes, links, output = scene_parts.node_material(name)
    info, emit = nodes.new("ShaderNodeObjectInfo"), nodes.new("ShaderNodeEmission")
    links.new(info.outputs["Random"], emit.inputs["Color"])
    links.new(emit.outputs[0], output.inputs["Surface"])
    return material


@pytest.mark.parametrize("name", ["Square", "Kübel.001"])
@pytest.mark.parametrize("instanced", [False, True])
def test_random_agrees_with_cycles(scene, render, name, instanced):
    scene_parts.add_camera(scene, ortho_scale=1.0)
    square = scene_parts.add_square(scene, name, 4.0, material=random_as_color("Random"))
    if instanced:
        part = bpy.data.collections.new("Part")
        part.objects.link(square)
        scene.collection.objects.unlink(square)
        place = scene_parts.add_object(scene, "Place", None)
        place.instance_type, place.instance_collection = "COLLECTION", part
    snapshot, _, _ = export_probe.through_engine(scene)
    ours = snapshot["instances"]["random"][0]

    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    passes = render(scene)
    red = next(values for key, values in passes.items() if key.endswith("Combined.R"))
    # The middle of the frame; single precision on both sides.
    assert red[24, 32] == pytest.approx(float(ours), abs=1e-6)
