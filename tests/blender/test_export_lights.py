# SPDX-License-Identifier: GPL-3.0-or-later
"""Strength of lights at the knots of the shutter."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from motion_parts import drive, on_every_step, with_shutter


def add_sun(scene, name="Sun", energy=1.0):
    sun = bpy.data.lights.new(name, "SUN")
    sun.energy = energy
    scene_parts.add_object(scene, name, sun)
    return sun


def exported(scene, **how):
    snapshot, _, _ = export_probe.through_engine(with_shutter(scene), **how)
    return {light["name"]: light for light in snapshot["lights"]}


def test_a_strength_that_rises_is_kept_with_two_knots(scene):
    drive(add_sun(scene), "energy", "frame")
    add_sun(scene, "Still", 3.0)
    lights = exported(scene, motion_steps=17)
    assert lights["Sun"]["energy"] == 10.0
    assert lights["Sun"]["energy_knots"] == pytest.approx([9.75, 10.25])
    assert lights["Still"]["energy"] == 3.0 and "energy_knots" not in lights["Still"]


def test_a_flash_has_more(scene):
    """On for the second half of the shutter: one of 16 segments is a ramp."""
    drive(add_sun(scene), "energy", "1.0 if frame > 10.0 else 0.0")
    knots = exported(scene, motion_steps=17)["Sun"]["energy_knots"]
    assert knots.tolist() == [0.0] * 9 + [1.0] * 8


def test_a_strength_that_nodes_say(scene):
    sun = add_sun(scene, energy=2.0)
    sun.use_nodes = True
    node = next(n for n in sun.node_tree.nodes if n.type == "EMISSION")
    drive(node.inputs["Strength"], "default_value", "frame - 9")
    assert exported(scene)["Sun"]["energy_knots"] == pytest.approx([1.5, 2.5])


def test_a_portal_sheds_no_light(scene):
    """It guides Cycles' samples to the world."""
    lamp = bpy.data.lights.new("Portal", "AREA")
    scene_parts.add_object(scene, "Portal", lamp)
    assert exported(scene)["Portal"]["energy"] > 0.0
    lamp.cycles.is_portal = True
    assert exported(scene)["Portal"]["energy"] == 0.0


def test_a_lamp_that_a_handler_deletes_shines_on(scene):
    """The frame is what it was when it began."""
    drive(add_sun(scene), "energy", "frame")

    def delete(_scene, _depsgraph):
        if "Sun" in bpy.data.objects:
            bpy.data.objects.remove(bpy.data.objects["Sun"])

    assert exported(scene, **on_every_step(delete))["Sun"]["energy"] == 10.0


def test_the_picture_is_lit_by_the_mean(scene, render):
    """A sun that rises from 0 to 2 through the shutter lights as one of strength 1."""
    with_shutter(scene)
    scene_parts.add_square(scene, size=20.0, material=scene_parts.matte())
    scene.granita.light_samples = 64
    sun = add_sun(scene)
    still = render(scene, "still")["ViewLayer.Combined.R"]
    drive(sun, "energy", "1 + 4 * (frame - 10)")
    rising = render(scene, "rising")["ViewLayer.Combined.R"]
    assert still.mean() == pytest.approx(0.8 / np.pi, rel=1e-3)
    assert rising.mean() == pytest.approx(still.mean(), rel=1e-3)
    assert rising == pytest.approx(still, rel=0.02)
