# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes in which light goes from surface to surface, and their pictures by both engines."""

import math

import bpy
import node_comparison
import numpy as np
import scene_parts
from mathutils import Vector


def closure(tree, kind, color, **inputs):
    """A shader's node; Glossy by the name that this Blender has for it."""
    shader = tree.add(kind if hasattr(bpy.types, kind) else "ShaderNodeBsdfAnisotropic")
    shader.inputs["Color"].default_value = (*color, 1.0)
    for name, value in inputs.items():
        shader.inputs[name].default_value = value
    return shader


def surface(thing, kind, color, **inputs):
    tree = node_comparison.Tree(thing)
    shader = closure(tree, kind, color, **inputs)
    tree.link(shader.outputs[0], tree.output.inputs["Surface"])
    return thing


def met_by_chance(material):
    """What it sends out has no light samples in Cycles."""
    cycles = material.cycles
    if hasattr(cycles, "emission_sampling"):
        cycles.emission_sampling = "NONE"
    else:
        cycles.sample_as_light = False


# Towards the camera's left, right, bottom and top; straight ahead.
WALLS = [
    ((-1, 0, 0), (0, math.pi / 2, 0), (0.6, 0.1, 0.1)),
    ((1, 0, 0), (0, -math.pi / 2, 0), (0.1, 0.5, 0.1)),
    ((0, -1, 0), (-math.pi / 2, 0, 0), (0.7, 0.7, 0.7)),
    ((0, 1, 0), (math.pi / 2, 0, 0), (0.7, 0.7, 0.7)),
    ((0, 0, -1), (0, 0, 0), (0.7, 0.7, 0.7)),
]


def room(scene):
    """Open behind the camera; a ball of half a metre, a point lamp above it."""
    for i, (place, turn, color) in enumerate(WALLS):
        wall = scene_parts.add_square(scene, f"Wall {i}", 2.0, place)
        wall.rotation_euler = turn
        surface(wall, "ShaderNodeBsdfDiffuse", color)
    angles = np.linspace(0, 2 * np.pi, 33)[:-1]
    rings = np.linspace(0, np.pi, 17)[1:-1]
    points = [
        (0.4 * math.sin(r) * math.cos(a), 0.4 * math.sin(r) * math.sin(a), 0.4 * math.cos(r))
        for r in rings
        for a in angles
    ]
    faces = [
        (32 * r + a, 32 * (r + 1) + a, 32 * (r + 1) + (a + 1) % 32, 32 * r + (a + 1) % 32)
        for r in range(14)
        for a in range(32)
    ]
    ball = scene_parts.add_mesh(scene, "Ball", points, faces, (0.3, -0.6, -0.3))
    ball.data.polygons.foreach_set("use_smooth", [True] * len(faces))
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy, lamp.shadow_soft_size = 30.0, 0.05
    scene_parts.add_object(scene, "Lamp", lamp, (0.0, 0.7, 0.0))
    camera = scene_parts.add_camera(scene, (0.0, 0.0, 3.2))
    camera.data.lens, camera.data.sensor_width = 36.0, 36.0
    scene.render.resolution_x = scene.render.resolution_y = 24
    return ball


def light_stage(scene, energy, grey):
    """A square lamp on the right of what stands at the origin, a grey sky."""
    lamp = bpy.data.lights.new("Lamp", "AREA")
    lamp.energy = energy
    lamp = scene_parts.add_object(scene, "Lamp", lamp, (3.0, -3.0, 5.0))
    lamp.rotation_euler = lamp.location.to_track_quat("Z", "Y").to_euler()
    scene_parts.set_world(scene, (grey, grey, grey))


def look_at_stage(scene, height, target):
    """A camera before it, black around; 64 x 48 pixels."""
    camera = scene_parts.add_camera(scene, (0.0, -5.0, height))
    way = Vector((0.0, 0.0, target)) - camera.location
    camera.rotation_euler = way.to_track_quat("-Z", "Y").to_euler()
    scene.render.resolution_x, scene.render.resolution_y = 64, 48


def worst_block(both):
    """Of 4 x 4 pixels, how far Granita's mean is from Cycles', of that and a bit of the picture's."""
    theirs, ours = (image.reshape(12, 4, 16, 4, 3).mean(axis=(1, 3, 4)) for image in both)
    return np.max(np.abs(ours - theirs) / (theirs + 0.15 * theirs.mean()))


def render_bounced(
    scene,
    render,
    cycles_samples,
    blur_glossy=0.0,
    bounces="FULL",
    all_passes=False,
    samples=16,
    limit=4,
    clamp=0.0,
    **limits,
):
    """(Cycles, Granita) with `limit` bounces or none, without clamps but of what is indirect: float32 [h, w, 3], or all passes by name."""
    cycles, settings = scene.cycles, scene.granita
    settings.bounces, settings.light_samples = bounces, 64
    cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 4
    for name, value in limits.items():
        setattr(cycles, name, value)
    cycles.sample_clamp_indirect, cycles.blur_glossy = clamp, blur_glossy
    scene.view_settings.view_transform = "Raw"
    cycles.samples = cycles_samples
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.max_bounces = limit if bounces == "FULL" else 0
    cycles.pixel_filter_type = "BOX"
    settings.samples, settings.pixel_filter, settings.filter_width = samples, "BOX", 1.0
    made = []
    for engine in ("CYCLES", "GRANITA"):
        scene.render.engine = engine
        passes = render(scene, engine)
        made.append(passes if all_passes else picture(passes, "Combined"))
    return made


def picture(passes, name):
    layer = next(key for key in passes if key.endswith(f".{name}.R"))[:-1]
    return np.stack([passes[layer + c] for c in "RGB"], axis=-1)
