# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplify's culling beside Cycles: shadows that fall into the picture from things outside of it."""

import math

import bpy
import numpy as np
import pytest
import scene_parts
from scene_parts import set_world

pytestmark = pytest.mark.lit


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
    theirs, ours = pictures(stage, render)
    assert np.abs(theirs - whole).mean() > 0.02 * whole.mean()
    assert np.abs(theirs - ours).mean() < 0.013 * whole.mean()


def test_far_things_alone_are_left_out_by_distance(stage, render):
    scene_parts.add_camera(stage, (0.0, 0.0, 10.0))
    whole, _ = pictures(stage, render)
    stage.cycles.use_distance_cull, stage.cycles.distance_cull_margin = True, 8.5
    theirs, ours = pictures(stage, render)
    assert np.abs(theirs - whole).mean() > 0.02 * whole.mean()
    assert np.abs(theirs - ours).mean() < 0.013 * whole.mean()


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
    theirs, ours = pictures(stage, render)
    assert np.abs(theirs - whole).mean() > 0.02 * whole.mean()
    assert np.abs(theirs - ours).mean() < 0.013 * whole.mean()
