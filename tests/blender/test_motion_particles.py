# SPDX-License-Identifier: GPL-3.0-or-later
"""Particles and other instances in motion, against Cycles (cycles_coverage)."""

import math

import bpy
import export_probe
import numpy as np
import pytest
import scene_parts
from cycles_coverage import blurred, expect_coverage_of_cycles
from motion_parts import drive


@pytest.fixture
def stage(scene):
    blurred(scene)
    scene_parts.add_camera(scene, (0, 0, 12))
    return scene


def emitter(scene, **settings):
    """Emits from a square that is not seen itself, upwards in the picture."""
    thing = scene_parts.add_square(scene, "Emitter", 5.0, (0, -3.0, 0))
    thing.rotation_euler.x = -math.pi / 2
    thing.show_instancer_for_render = False
    thing.modifiers.new("Particles", "PARTICLE_SYSTEM")
    system = thing.particle_systems[0].settings
    system.count, system.frame_start, system.frame_end = 40, -10, 8
    system.lifetime, system.normal_factor = 50, 4.0
    system.effector_weights.gravity = 0.3
    system.particle_size, system.use_scale_instance = 1.0, False
    for name, value in settings.items():
        setattr(system, name, value)
    return system


def flake(scene, name="Flake", size=0.5):
    return scene_parts.add_square(scene, name, size, (0, 0, -90))


def played(scene):
    """From the first frame on, as an animation is."""
    for frame in range(-10, 13):
        scene.frame_set(frame)
    scene.frame_set(10)


def objects(scene):
    emitter(scene, render_type="OBJECT", instance_object=flake(scene))


def spinning_objects(scene):
    emitter(
        scene,
        render_type="OBJECT",
        instance_object=flake(scene, size=1.0),
        use_rotations=True,
        angular_velocity_mode="GLOBAL_Z",
        angular_velocity_factor=20.0,
    )


def collections(scene):
    part = bpy.data.collections.new("Flakes")
    for i in range(3):
        part.objects.link(flake(scene, f"Flake{i}", 0.3 + 0.2 * i))
    emitter(
        scene, render_type="COLLECTION", instance_collection=part, use_collection_pick_random=True
    )


def those_that_are_born_and_die(scene):
    """Nine a frame, for five frames: in every shutter some come and some go."""
    emitter(
        scene,
        count=200,
        frame_end=12,
        lifetime=5,
        render_type="OBJECT",
        instance_object=flake(scene),
    )


def on_hair_that_moves(scene):
    system = emitter(scene, type="HAIR", hair_length=2.0)
    system.render_type, system.instance_object = "OBJECT", flake(scene)
    drive(scene.objects["Emitter"], "location", "(frame - 10) / 2", 0)


@pytest.mark.parametrize(
    "build",
    [objects, spinning_objects, collections, on_hair_that_moves],
)
def test_particles_are_blurred_as_in_cycles(stage, render, build):
    build(stage)
    played(stage)
    snapshot, _, _ = export_probe.through_engine(stage)
    assert (snapshot["instances"]["knots"] > 1).sum() > 10
    expect_coverage_of_cycles(stage, render)


def test_particles_keep_their_identity_through_births_and_deaths(stage):
    """Each goes its own way: none jumps to where another was.  Those of the frame are there, throughout the
    shutter; those that are born after it are not: as many as there are at any time.  (Cycles hides
    whatever does not live through all of it.)"""
    those_that_are_born_and_die(stage)
    played(stage)
    snapshot, _, _ = export_probe.through_engine(stage)
    instances = snapshot["instances"]
    first = np.cumsum(instances["knots"]) - instances["knots"]
    flying = np.flatnonzero(instances["knots"] > 1)
    places = instances["world_from_object"][:, :3, 3]
    steps = [
        np.linalg.norm(places[first[i] + instances["knots"][i] - 1] - places[first[i]])
        for i in flying
    ]
    living = stage.objects["Emitter"].evaluated_get(bpy.context.evaluated_depsgraph_get())
    states = [p.alive_state for p in living.particle_systems[0].particles]
    # The flake itself stands far below.
    assert len(instances["name"]) == states.count("ALIVE") + 1
    # 4 metres a second, and less up against gravity: at most .16 m in a frame of 1/24 s.
    assert len(flying) > 20 and max(steps) < 0.2
