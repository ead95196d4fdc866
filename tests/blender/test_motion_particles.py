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
    """Each goes its own way: none jumps to where another was.  Each is there while it lives, to the fraction
    of a frame.  (Cycles hides whatever does not live through the whole shutter.)"""
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
    # 4 metres a second, and less up against gravity: at most .16 m in a frame of 1/24 s.
    assert len(flying) > 20 and max(steps) < 0.2
    living = stage.objects["Emitter"].evaluated_get(bpy.context.evaluated_depsgraph_get())
    lives = [
        (max(0.0, p.birth_time - 9.5), min(p.die_time - 9.5, 1.0))
        for p in living.particle_systems[0].particles
        if p.birth_time < 10.5 and p.die_time > 9.5
    ]
    # The flake itself stands far below.
    expected = np.array(sorted([*lives, (0.0, 1.0)]))
    assert np.array(sorted(instances["lifespan"].tolist())) == pytest.approx(expected, abs=1e-5)
    comes = [open for open, close in lives if open > 0]
    goes = [close for open, close in lives if close < 1]
    assert len(comes) > 5 and len(goes) > 5


@pytest.mark.parametrize(
    "birth, lifetime, alone, alpha",
    [
        (9.8, 50, False, 0.7),
        (10.2, 50, False, 0.3),
        (5.0, 5.25, False, 0.75),
        (10.2, 50, True, 0.3),
    ],
    ids=["born before the frame", "born after it", "dying", "the first of its kind"],
)
def test_a_particle_that_is_born_or_dies_covers_its_share_of_the_shutter(
    stage, render, birth, lifetime, alone, alpha
):
    """One particle, as large as the picture; the shutter is open from 9.5 to 10.5."""
    thing = flake(stage, size=40.0)
    thing.location.x = 500.0  # out of the picture itself
    system = emitter(
        stage,
        count=1,
        frame_start=birth,
        frame_end=birth,
        lifetime=lifetime,
        normal_factor=0.0,
        render_type="OBJECT",
        instance_object=thing,
    )
    system.effector_weights.gravity = 0.0
    if alone:
        stage.collection.objects.unlink(thing)
        hidden = bpy.data.collections.new("Elsewhere")
        hidden.objects.link(thing)
    played(stage)
    stage.granita.samples = 64
    stage.granita.pixel_filter, stage.granita.filter_width = "BOX", 1.0
    passes = render(stage, "GRANITA")
    values = next(values for key, values in passes.items() if key.endswith("Combined.A"))
    # A pixel has a sample in each 64th of the shutter.
    assert values[8:-8, 8:-8] == pytest.approx(alpha, abs=1 / 64 + 1e-5)


def test_a_spray_is_the_same_frame_by_frame_with_persistent_data(stage):
    """What appears within one frame's shutter is not kept for the next."""
    those_that_are_born_and_die(stage)
    played(stage)

    def counts(persistent):
        return [
            (len(job.snapshot["instances"]["name"]), job.snapshot["instances"]["lifespan"].tolist())
            for job in export_probe.frame_by_frame(stage, (9, 10, 11), persistent=persistent)
        ]

    assert counts(True) == counts(False)
