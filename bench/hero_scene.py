# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene of hero.py, built inside Blender."""

import math

import bpy
import numpy as np
import scenes


def grid_mesh(name, points):
    """Smooth quads between points [rows, columns, 3]."""
    rows, columns = points.shape[0] - 1, points.shape[1] - 1
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    corners = np.stack([first, first + 1, first + columns + 2, first + columns + 1], axis=1)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(points.size // 3)
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    mesh.loops.add(corners.size)
    mesh.loops.foreach_set("vertex_index", corners.astype(np.int32).ravel())
    mesh.polygons.add(len(corners))
    mesh.polygons.foreach_set("loop_start", np.arange(0, corners.size, 4, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(len(corners), 4, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(corners), dtype=bool))
    mesh.update(calc_edges=True)
    return mesh


def hero(side=1000):
    """A subdivided cage of a million faces, half a pixel each, that moves by 2 pixels in the sun."""
    scene = scenes.empty(960)
    scene.render.threads_mode = "AUTO"
    across, up = np.meshgrid(np.linspace(-8, 8, side + 1), np.linspace(-4.5, 4.5, side + 1))
    depth = 0.3 * np.sin(1.5 * across) * np.sin(2 * up) + 0.02 * np.sin(20 * across) * np.sin(
        18 * up
    )
    mesh = grid_mesh("Hero", np.stack([across, up, depth], axis=-1))
    mesh.materials.append(scenes.material("Clay", "ShaderNodeBsdfDiffuse", (0.8, 0.6, 0.4)))
    thing = scenes.add(scene, "Hero", mesh)
    modifier = thing.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    scenes.animate(thing, "location", 0, 2 * scenes.pixel(scene))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, math.radians(0.5)
    scenes.add(scene, "Sun", sun).rotation_euler = (0.6, 0.5, 0.0)
    scenes.add_camera(scene, (0, 0, 20))
    scene.frame_set(1)
    return scene
