# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes by chance, one a seed, of what artists put into scenes.  Runs inside Blender."""

import math

import bpy
import engines
import numpy as np
from mathutils import Vector
from random_materials import color, material
from scenes import SHUTTER, animate, empty

WIDTH = 240


def grid(**place):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12, size=2, **place)


def text(**place):
    bpy.ops.object.text_add(**place)
    bpy.context.object.data.body = "Ag"
    bpy.context.object.data.extrude, bpy.context.object.data.bevel_depth = 0.1, 0.02


def spline(**place):
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.8, **place)
    bpy.context.object.data.bevel_depth = 0.2


def blob(**place):
    bpy.ops.object.metaball_add(radius=0.9, **place)


SHAPES = (
    lambda **place: bpy.ops.mesh.primitive_cube_add(size=1.4, **place),
    lambda **place: bpy.ops.mesh.primitive_uv_sphere_add(radius=0.9, **place),
    lambda **place: bpy.ops.mesh.primitive_ico_sphere_add(radius=0.9, subdivisions=3, **place),
    lambda **place: bpy.ops.mesh.primitive_torus_add(major_radius=0.7, minor_radius=0.3, **place),
    lambda **place: bpy.ops.mesh.primitive_cylinder_add(radius=0.7, depth=1.6, **place),
    lambda **place: bpy.ops.mesh.primitive_cone_add(radius1=0.9, depth=1.6, **place),
    lambda **place: bpy.ops.mesh.primitive_monkey_add(size=1.6, **place),
    grid,
    text,
    spline,
    blob,
)


def change(item, random):
    """Modifiers, smoothness, and what rays may see it."""
    if item.type == "MESH":
        if random.random() < 0.6:
            bpy.ops.object.shade_smooth()
        for kind, chance in (("SUBSURF", 0.3), ("SOLIDIFY", 0.1), ("BEVEL", 0.15), ("WAVE", 0.1)):
            if random.random() < chance:
                item.modifiers.new(kind, kind)
        if random.random() < 0.15:
            array = item.modifiers.new("ARRAY", "ARRAY")
            array.count, array.relative_offset_displace = 3, (0.4, 0.3, 0.5)
    for name in ("camera", "diffuse", "glossy", "transmission", "shadow"):
        if random.random() < 0.03:
            setattr(item, f"visible_{name}", False)


def move(item, random):
    """Along a way, or around."""
    path = random.choice(("location", "rotation_euler"))
    for axis, change in enumerate(random.normal(0, 0.15, 3)):
        animate(item, path, axis, change)


def hair(item, random):
    item.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = item.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 400
    settings.hair_length, settings.root_radius = 0.4, 3.0
    settings.child_type = random.choice(("NONE", "INTERPOLATED"))
    settings.rendered_child_count = 5


def thing(index, random):
    angle = random.uniform(0, 2 * math.pi)
    far = 0.6 + 0.45 * index
    place = (far * math.cos(angle), far * math.sin(angle), random.uniform(0.5, 1.5))
    turned = random.uniform(-0.7, 0.7, 3)
    SHAPES[random.integers(len(SHAPES))](location=place, rotation=turned)
    item = bpy.context.object
    item.scale = (
        random.uniform(0.5, 1.1, 3) if random.random() < 0.3 else [random.uniform(0.5, 1.1)] * 3
    )
    item.data.materials.append(material(f"Material {index}", random, random.random() < 0.12))
    change(item, random)
    if item.type == "MESH" and random.random() < 0.08:
        hair(item, random)
    # Cycles mixes up the vertices of metaballs that move.
    if item.type != "META" and random.random() < 0.3:
        move(item, random)
    if random.random() < 0.15:
        for turn in range(5):
            copy = bpy.data.objects.new(f"{item.name} {turn}", item.data)
            copy.location = random.uniform(-2.5, 2.5, 3) * (1, 1, 0) + (0, 0, 0.3)
            copy.scale = [0.3] * 3
            bpy.context.collection.objects.link(copy)


def room(random):
    """A floor, and with some luck walls."""
    bpy.ops.mesh.primitive_plane_add(size=14)
    bpy.context.object.data.materials.append(material("Floor", random))
    for at, turn in (
        ((0, 3.5, 3), (math.pi / 2, 0, 0)),
        ((-3.5, 0, 3), (math.pi / 2, 0, math.pi / 2)),
    ):
        if random.random() < 0.4:
            bpy.ops.mesh.primitive_plane_add(size=7, location=at, rotation=turn)
            bpy.context.object.data.materials.append(material("Wall", random))


def lamps(random):
    for _ in range(random.integers(1, 4)):
        kind = random.choice(("POINT", "SUN", "SPOT", "AREA"))
        away = Vector(random.normal(0, 1, 3))
        away.z = abs(away.z) + 0.5
        away.normalize()
        turned = away.to_track_quat("Z", "Y").to_euler()
        bpy.ops.object.light_add(type=kind, location=6 * away, rotation=turned)
        item, data = bpy.context.object, bpy.context.object.data
        data.energy = random.uniform(0.5, 3) if kind == "SUN" else random.uniform(150, 900)
        data.color = color(random, 1.0)[:3]
        if kind == "AREA":
            data.shape, data.size = (
                random.choice(("SQUARE", "DISK", "RECTANGLE", "ELLIPSE")),
                random.uniform(0.2, 3),
            )
        elif kind != "SUN":
            data.shadow_soft_size = random.uniform(0, 0.8)
        if random.random() < 0.2:
            move(item, random)


def world(scene, random):
    made = scene.world
    made.use_nodes = True
    background = made.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = color(random)
    background.inputs["Strength"].default_value = random.uniform(0, 0.8)
    if random.random() < 0.3:
        sky = made.node_tree.nodes.new("ShaderNodeTexSky")
        sky.sun_elevation, sky.sun_rotation = random.uniform(0.1, 1.3), random.uniform(0, 6)
        sky.sun_disc = bool(random.random() < 0.5)
        background.inputs["Strength"].default_value = random.uniform(0.02, 0.1)
        made.node_tree.links.new(sky.outputs[0], background.inputs["Color"])


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
    if random.random() < 0.1:
        data.type, data.ortho_scale = "ORTHO", 6
    if random.random() < 0.2:
        move(scene.camera, random)


def build(seed):
    """(scene, frame at which the shutter opens, frames that it stays open)"""
    random = np.random.default_rng(int(seed))
    scene = empty(WIDTH)
    room(random)
    for index in range(random.integers(3, 8)):
        thing(index, random)
    lamps(random)
    world(scene, random)
    view(scene, random)
    scene.frame_set(1)
    return scene, 1, SHUTTER if random.random() < 0.5 else 0.0
