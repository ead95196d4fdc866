# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes by chance, one a seed, of what artists put into scenes.  Runs inside Blender."""

import math

import bpy
import engines
import numpy as np
from mathutils import Vector
from random_light import lamps, link_light, world
from random_materials import material
from random_things import move, thing
from scenes import SHUTTER, empty

WIDTH = 240


def room(random):
    """A floor, and with some luck walls."""
    bpy.ops.mesh.primitive_plane_add(size=14)
    floor = bpy.context.object
    floor.data.materials.append(material("Floor", random))
    for at, turn in (
        ((0, 3.5, 3), (math.pi / 2, 0, 0)),
        ((-3.5, 0, 3), (math.pi / 2, 0, math.pi / 2)),
    ):
        if random.random() < 0.4:
            bpy.ops.mesh.primitive_plane_add(size=7, location=at, rotation=turn)
            bpy.context.object.data.materials.append(material("Wall", random))
    return floor


def view(scene, random):
    angle = random.uniform(0, 2 * math.pi)
    if random.random() < 0.6:  # before the walls
        angle = random.uniform(-1.4, 0.0)
    at = Vector((7 * math.cos(angle), 7 * math.sin(angle), random.uniform(1.2, 4)))
    engines.add_camera(scene, at, (0, 0, 0.8), random.uniform(28, 60))
    data = scene.camera.data
    if random.random() < 0.25:
        data.dof.use_dof, data.dof.focus_distance = True, at.length
        data.dof.aperture_fstop = random.uniform(0.2, 2)
        data.dof.aperture_blades = int(random.choice((0, 3, 6)))
        data.dof.aperture_ratio = random.uniform(0.6, 1.5)
    if random.random() < 0.1:
        data.type, data.ortho_scale = "ORTHO", 6
    if random.random() < 0.1:
        data.shift_x, data.shift_y = random.uniform(-0.2, 0.2, 2)
    if random.random() < 0.2:
        move(scene.camera, random)


def settings(scene, floor, random):
    """Of the film."""
    if random.random() < 0.2:
        scene.render.film_transparent = True
        floor.is_shadow_catcher = bool(random.random() < 0.5)
        scene.cycles.film_transparent_glass = bool(random.random() < 0.5)
    scene.cycles.film_exposure = random.uniform(0.7, 1.3)
    if random.random() < 0.2:
        scene.render.pixel_aspect_x = random.uniform(1, 1.5)


def build(seed):
    """(scene, frame at which the shutter opens, frames that it stays open)"""
    random = np.random.default_rng(int(seed))
    scene = empty(WIDTH)
    floor = room(random)
    things = [thing(index, random) for index in range(random.integers(3, 8))]
    for item in lamps(random):
        if random.random() < 0.1:
            link_light(item, [floor, *things], random)
    world(scene, random)
    view(scene, random)
    settings(scene, floor, random)
    scene.frame_set(1)
    return scene, 1, SHUTTER if random.random() < 0.5 else 0.0
