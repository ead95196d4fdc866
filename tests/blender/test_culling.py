# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplify's culling beside Cycles: shadows that fall into the picture from things outside of it."""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from export_probe import through_engine
from scene_parts import set_world


@pytest.fixture
def stage(scene):
    """Forty cubes of half a metre at random over a floor, a sun that stands low."""
    floor = scene_parts.add_square(scene, "Floor", 60.0)
    floor.cycles.use_camera_cull = floor.cycles.use_distance_cull = False
    scene_parts.add_object(scene, "Sun", bpy.data.lights.new("Sun", "SUN"))
    scene.objects["Sun"].data.energy = 3.0
    scene.objects["Sun"].rotation_euler = (math.radians(72), 0.0, math.radians(30))
    set_world(scene, (0.1, 0.1, 0.1))
    random = np.random.default_rng(3)
    bpy.ops.mesh.primitive_cube_add(size=0.5)
    mesh = bpy.context.object.data
    bpy.data.objects.remove(bpy.context.object)
    for i, place in enumerate(random.uniform((-9, -9, 0.4), (9, 9, 3.0), (40, 3))):
        cube = scene_parts.add_object(scene, f"Cube {i}", mesh, place)
        cube.cycles.use_camera_cull = i % 4 != 0
        cube.cycles.use_distance_cull = i % 3 != 0
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    scene.render.use_simplify = True
    return scene


def pictures(scene, render):
    """(Cycles, Granita), float32 [48, 64]."""
    ours, theirs = scene_parts.direct_light_of_both(scene, render, 64)
    name = next(name for name in theirs if name.endswith("Combined.R"))
    return theirs[name], ours[name]


def agree(stage, render, whole):
    """Of what is missing a tenth at most may be otherwise, and noise."""
    theirs, ours = pictures(stage, render)
    effect = np.abs(theirs - whole).mean()
    assert effect > 0.02 * whole.mean()
    assert np.abs(theirs - ours).mean() < 0.1 * effect + 0.011 * whole.mean()


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("margin", [0.0, 0.4])
@pytest.mark.parametrize("distance", [None, 9.0])
def test_what_is_left_out_is_what_cycles_leaves_out(stage, render, kind, margin, distance):
    camera = scene_parts.add_camera(stage, (1.0, -2.0, 8.0))
    camera.rotation_euler = (math.radians(20), 0.0, math.radians(15))
    camera.data.type, camera.data.ortho_scale, camera.data.shift_x = kind, 6.0, 0.1
    whole, _ = pictures(stage, render)
    cycles = stage.cycles
    cycles.use_camera_cull, cycles.camera_cull_margin = True, margin
    if distance:
        cycles.use_distance_cull, cycles.distance_cull_margin = True, distance
    agree(stage, render, whole)


def test_far_things_alone_are_left_out_by_distance(stage, render):
    scene_parts.add_camera(stage, (0.0, 0.0, 10.0))
    whole, _ = pictures(stage, render)
    stage.cycles.use_distance_cull, stage.cycles.distance_cull_margin = True, 8.5
    agree(stage, render, whole)


def test_instances_are_left_out_one_by_one(stage, render):
    cubes = bpy.data.collections.new("Cubes")
    for thing in list(stage.objects):
        if thing.name.startswith("Cube"):
            stage.collection.objects.unlink(thing)
            cubes.objects.link(thing)
    placed = scene_parts.add_object(stage, "Placed", None)
    placed.instance_type, placed.instance_collection = "COLLECTION", cubes
    scene_parts.add_camera(stage, (1.0, -2.0, 8.0))
    whole, _ = pictures(stage, render)
    stage.cycles.use_camera_cull, stage.cycles.camera_cull_margin = True, 0.0
    agree(stage, render, whole)


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("clip", [0.1, 1.5])
def test_things_beside_and_behind_the_camera(stage, render, kind, clip):
    """It stands among them and looks ahead."""
    camera = scene_parts.add_camera(stage, (0.5, -1.0, 1.5))
    tilt = 80 if kind == "PERSP" else 50
    camera.rotation_euler = (math.radians(tilt), 0.0, math.radians(15))
    camera.data.type, camera.data.ortho_scale, camera.data.clip_start = kind, 6.0, clip
    whole, _ = pictures(stage, render)
    stage.cycles.use_camera_cull, stage.cycles.camera_cull_margin = True, 0.1
    agree(stage, render, whole)


def add_moving_camera(stage):
    camera = scene_parts.add_camera(stage, (1.0, -2.0, 8.0))
    for frame, x in ((0, -5.0), (1, 1.0), (2, 7.0)):
        camera.location.x = x
        camera.keyframe_insert("location", frame=frame)
    stage.render.use_motion_blur = True
    stage.frame_set(1)


def test_a_camera_that_moves_leaves_out_as_it_stands_at_the_frame(stage, render):
    add_moving_camera(stage)
    whole, _ = pictures(stage, render)
    stage.cycles.use_camera_cull, stage.cycles.camera_cull_margin = True, 0.0
    agree(stage, render, whole)


def test_what_comes_within_the_shutter_changes_nothing_of_what_is_left_out(stage):
    """By a camera that moves: it is looked from where that stands at the frame."""
    add_moving_camera(stage)
    stage.cycles.use_camera_cull, stage.cycles.camera_cull_margin = True, 0.0
    names = []
    for comes in (False, True):
        if comes:
            late = scene_parts.add_square(stage, "Late", 0.5, (1.0, -2.0, 1.0))
            late.cycles.use_camera_cull = False
            for frame, hidden in ((0, True), (1, True), (2, False)):
                late.hide_render = hidden
                late.keyframe_insert("hide_render", frame=frame)
            stage.frame_set(1)
        names.append({*through_engine(stage)[0]["instances"]["name"]} - {"Late"})
    assert names[0] == names[1] and len(names[0]) < 35
