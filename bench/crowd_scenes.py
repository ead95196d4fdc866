# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of crowd.py, built inside Blender: things of many more faces than samples see of them."""

import math

import bpy
import hero_scene
import numpy as np
import scenes


def sheet(side, size, seed):
    """A crumpled square of `side` squared faces, `size` metres wide."""
    across, up = np.meshgrid(np.linspace(-0.5, 0.5, side + 1), np.linspace(-0.5, 0.5, side + 1))
    phase = np.random.default_rng(seed).uniform(0, 6, 2)
    depth = 0.2 * np.sin(9 * across + phase[0]) * np.cos(7 * up + phase[1])
    points = size * np.stack([across, up, depth], axis=-1)
    return hero_scene.grid_mesh("Sheet", points)


def scatter(scene, mesh, count, spread, seed):
    """The mesh at each of `count` vertices of a carrier, turned as their normals are."""
    random = np.random.default_rng(seed)
    carrier = bpy.data.meshes.new("Places")
    carrier.vertices.add(count)
    places = np.stack([*random.uniform(-spread, spread, (2, count)), random.uniform(0, 2, count)])
    carrier.vertices.foreach_set("co", places.T.astype(np.float32).ravel())
    owner = scenes.add(scene, "Places", carrier)
    owner.instance_type = "VERTS"
    owner.use_instance_vertices_rotation = True
    thing = scenes.add(scene, "Thing", mesh)
    thing.parent = owner
    thing.rotation_euler = (1.1, 0.3, 0.0)
    return owner


def crowd(count, moves=False):
    """`count` things of 10,000 faces each, four pixels wide of 960, in the sun."""
    scene = scenes.empty(960)
    scene.render.threads_mode = "AUTO"
    mesh = sheet(100, 0.35, 1)
    mesh.materials.append(scenes.material("Clay", "ShaderNodeBsdfDiffuse", (0.8, 0.6, 0.4)))
    owner = scatter(scene, mesh, count, 45.0, 2)
    if moves:
        scenes.animate(owner, "location", 0, 1.0)
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, math.radians(0.5)
    scenes.add(scene, "Sun", sun).rotation_euler = (0.6, 0.5, 0.0)
    scenes.add_camera(scene, (0, -72, 30), tilt=math.radians(67))
    scene.frame_set(1)
    return scene


SCENES = {
    "10,000 things": lambda: crowd(10_000),
    "100,000 things": lambda: crowd(100_000),
    "100,000 things that move": lambda: crowd(100_000, moves=True),
}
