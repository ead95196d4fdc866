# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps that collections, nodes and particles instance: each moves, comes and goes as instances do."""

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from motion_parts import drive, with_shutter
from node_parts import hidden_collection, instances_on_line


@pytest.fixture
def moving(scene):
    """The shutter is open from 9.75 to 10.25; read at five times."""
    return with_shutter(scene)


def lamp(scene, kind="POINT", energy=100.0):
    data = bpy.data.lights.new("Lamp", kind)
    data.energy = energy
    return scene_parts.add_object(scene, "Lamp", data)


def count_of(scene, formula):
    """Instances of a lamp on a line, 3 metres apart."""
    tree, node = instances_on_line(scene, lamp(scene), 3)
    drive(tree, f'nodes["{node.name}"].inputs["Count"].default_value', formula)
    return scene.objects["Host"]


def exported(scene):
    snapshot, report, _ = export_probe.through_engine(scene, motion_steps=17)
    assert len(report) == 0
    return snapshot["lights"]


def lives(lights):
    return sorted(
        (float(light["world_from_light"][0, 0, 3]), *map(float, light.get("lifespan", (0.0, 1.0))))
        for light in lights
    )


def test_collections_and_nodes_move_their_lamps(moving):
    host = count_of(moving, "2")
    group = hidden_collection(moving, lamp(moving))
    place = scene_parts.add_object(moving, "Place", None, (0, 5, 0))
    place.instance_type, place.instance_collection = "COLLECTION", group
    for thing in (host, place):
        drive(thing, "location", "4 * frame", 2)
    lights = exported(moving)
    assert len(lights) == 3
    for light in lights:
        assert light["world_from_light"][[0, -1], 2, 3] == pytest.approx([39.0, 41.0])
    assert lives(lights) == [(0.0, 0.0, 1.0), (0.0, 0.0, 1.0), (3.0, 0.0, 1.0)]


@pytest.mark.parametrize(
    "formula, expected",
    [
        ("1 if frame < 10.05 else 2", [(0.0, 0.0, 1.0), (3.0, 0.625, 1.0)]),
        ("2 if frame < 10.05 else 1", [(0.0, 0.0, 1.0), (3.0, 0.0, 0.625)]),
        ("0 if frame < 10.05 else 1", [(0.0, 0.625, 1.0)]),
        ("0 if 9.95 < frame < 10.05 else 1", [(0.0, 0.0, 0.375), (0.0, 0.625, 1.0)]),
    ],
)
def test_lamps_that_come_and_go(moving, formula, expected):
    count_of(moving, formula)
    assert lives(exported(moving)) == expected


def test_each_has_the_strength_of_its_lamp(moving):
    count_of(moving, "2 if 9.8 < frame < 10.2 else 1")
    drive(bpy.data.lights["Lamp"], "energy", "100 * (frame - 9)")
    lights = exported(moving)
    assert len(lights) == 2
    for light in lights:
        assert light["energy_knots"] == pytest.approx([75.0, 125.0])


def test_the_first_of_a_lamp_has_its_own_strength_too(moving):
    """It comes at 10.0625.  Nothing of it is placed at the frame, when it is twice as strong as at the end."""
    count_of(moving, "0 if frame < 10.05 else 1")
    drive(bpy.data.lights["Lamp"], "energy", "200 - 400 * (frame - 10)")
    (light,) = exported(moving)
    assert light["lifespan"] == pytest.approx([0.625, 1.0])
    assert light["energy_knots"] == pytest.approx([300.0, 100.0])


def test_particles_carry_lamps(moving):
    """Born at the frames 8, 9 and 10."""
    emitter = scene_parts.add_square(moving, "Emitter")
    emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 3, 8, 11.0, 50
    settings.physics_type, settings.render_type = "NO", "OBJECT"
    settings.instance_object = lamp(moving)
    hidden_collection(moving, settings.instance_object)
    assert [open for _, open, _ in lives(exported(moving))] == pytest.approx([0.0, 0.0, 0.5])


def test_what_is_hidden_at_the_frame_is_dark(moving):
    host = count_of(moving, "3")
    host.hide_render = True
    host.keyframe_insert("hide_render", frame=10)
    host.hide_render = False
    host.keyframe_insert("hide_render", frame=10.1)
    moving.frame_set(9)
    moving.frame_set(10)
    assert exported(moving) == []


def test_an_instance_lights_as_its_lamp_would(moving, render):
    """Bit by bit: a lamp that flies, by itself and placed by nodes that fly."""
    scene_parts.add_square(moving, size=20.0)
    shining = lamp(moving)
    drive(shining, "location", "4 * (frame - 10)", 0)
    shining.location.z = 2.0
    alone = render(moving, "alone")["ViewLayer.Combined.R"]
    shining.driver_remove("location", 0)
    shining.location = (0, 0, 0)
    instances_on_line(moving, shining, 1)
    host = moving.objects["Host"]
    drive(host, "location", "4 * (frame - 10)", 0)
    host.location.z = 2.0
    placed = render(moving, "placed")["ViewLayer.Combined.R"]
    assert alone.max() > 0.1 and np.array_equal(alone, placed)


def test_it_lights_for_as_long_as_it_is_there(moving, render):
    """A sun that comes after 5/8 of the shutter."""
    scene_parts.add_square(moving, size=20.0, material=scene_parts.matte())
    moving.granita.light_samples = 64
    count_of(moving, "0 if frame < 10.05 else 1")
    bpy.data.lights["Lamp"].type = "SUN"
    bpy.data.lights["Lamp"].energy = 1.0
    picture = render(moving)["ViewLayer.Combined.R"]
    # A net of 64 times, whose first coordinate meets an end of eighths exactly.
    assert picture == pytest.approx(np.full_like(picture, 0.375 * 0.8 / np.pi), rel=1e-3)
