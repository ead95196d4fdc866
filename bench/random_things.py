# SPDX-License-Identifier: GPL-3.0-or-later
"""Things by chance: shapes, how they are changed, moved, copied and seen.  Runs inside Blender."""

import math

import bpy
import numpy as np
from random_materials import material
from scenes import animate


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
    lambda **place: bpy.ops.surface.primitive_nurbs_surface_torus_add(radius=0.7, **place),
    grid,
    text,
    spline,
    blob,
)
CLOSED = range(6)  # what can be filled


def tint(mesh, random):
    """Colours of corners or points, by the name that materials ask for."""
    where = random.choice(("POINT", "CORNER"))
    kind = random.choice(("FLOAT_COLOR", "BYTE_COLOR"))
    made = mesh.color_attributes.new("Tint", kind, where)
    count = len(made.data)
    colors = np.concatenate([random.uniform(0, 1, (count, 3)), np.ones((count, 1))], 1)
    made.data.foreach_set("color", colors.astype(np.float32).ravel())


def bend(item, random):
    """A shape key that is on its way."""
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Bent")
    for point in key.data:
        point.co.x += 0.3 * point.co.z * point.co.z
    for frame, value in ((0, 0.0), (2, float(random.uniform(0.5, 1)))):
        key.value = value
        key.keyframe_insert("value", frame=frame)


def change(item, displaces, random):
    """Modifiers, smoothness, and what rays may see it."""
    if item.type == "MESH":
        tint(item.data, random)
        if random.random() < 0.6:
            bpy.ops.object.shade_smooth()
        if random.random() < 0.1:
            bend(item, random)
        for kind, chance in (("SUBSURF", 0.3), ("SOLIDIFY", 0.1), ("BEVEL", 0.15), ("WAVE", 0.1)):
            if random.random() < chance:
                item.modifiers.new(kind, kind)
        if random.random() < 0.15:
            array = item.modifiers.new("ARRAY", "ARRAY")
            array.count, array.use_relative_offset = 3, False
            array.use_constant_offset, array.constant_offset_displace = True, (0.5, 0.4, 0.7)
        if random.random() < 0.05:
            item.modifiers.new("WIREFRAME", "WIREFRAME")
        if displaces:  # of Cycles the vertices move alone
            fine = item.modifiers.new("SUBSURF", "SUBSURF")
            fine.subdivision_type, fine.render_levels = "SIMPLE", 4
    # Not "shadow": what passes then is in Cycles a matter of how it chose the lamp.
    for name in ("camera", "diffuse", "glossy", "transmission", "volume_scatter"):
        if random.random() < 0.03:
            setattr(item, f"visible_{name}", False)
    item.is_holdout = bool(random.random() < 0.02)
    item.pass_index, item.color = 1, random.uniform(0.1, 1, 4)


def move(item, random):
    """Along a way, or around, or it grows."""
    path = random.choice(("location", "rotation_euler", "scale"))
    for axis, change in enumerate(random.normal(0, 0.15, 3)):
        animate(item, path, axis, change)


def hair(item, random):
    item.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = item.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 400
    settings.hair_length, settings.root_radius = 0.4, 3.0
    settings.child_type = random.choice(("NONE", "INTERPOLATED"))
    settings.rendered_child_count = 5


def copies(item, random):
    """Linked ones, beside it, turned and smaller; some with a material of their own."""
    for turn in range(5):
        copy = bpy.data.objects.new(f"{item.name} {turn}", item.data)
        copy.location = random.uniform(-2.5, 2.5, 3) * (1, 1, 0) + (0, 0, 0.3)
        copy.rotation_euler, copy.scale = random.uniform(-3, 3, 3), [0.3] * 3
        copy.color = random.uniform(0.1, 1, 4)
        bpy.context.collection.objects.link(copy)
        if random.random() < 0.2:
            copy.material_slots[0].link = "OBJECT"
            copy.material_slots[0].material = material(f"{copy.name} alone", random)


def scattered(item, random):
    """Grains of it on its own faces, by dupli-faces of a plane that carries them."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=5)
    carrier = bpy.context.object
    carrier.instance_type = random.choice(("FACES", "VERTS"))
    carrier.use_instance_faces_scale, carrier.instance_faces_scale = True, 0.3
    carrier.show_instancer_for_render = False
    child = bpy.data.objects.new(f"{item.name} grain", item.data)
    child.scale, child.parent = [0.15] * 3, carrier
    bpy.context.collection.objects.link(child)


def thing(index, random):
    angle = random.uniform(0, 2 * math.pi)
    far = 0.6 + 0.45 * index
    place = (far * math.cos(angle), far * math.sin(angle), random.uniform(0.5, 1.5))
    shape = random.integers(len(SHAPES))
    SHAPES[shape](location=place, rotation=random.uniform(-0.7, 0.7, 3))
    item = bpy.context.object
    item.scale = (
        random.uniform(0.5, 1.1, 3) if random.random() < 0.3 else [random.uniform(0.5, 1.1)] * 3
    )
    displaces, filled = random.random() < 0.12, shape in CLOSED and random.random() < 0.08
    item.data.materials.append(material(f"Material {index}", random, displaces, filled))
    if item.type == "MESH" and random.random() < 0.15:
        item.data.materials.append(material(f"Material {index} beside", random))
        for face in item.data.polygons:
            face.material_index = int(random.integers(2))
    change(item, displaces, random)
    if item.type == "MESH" and random.random() < 0.08:
        hair(item, random)
    # Cycles mixes up the vertices of metaballs that move.
    if item.type != "META" and random.random() < 0.3:
        move(item, random)
    if item.type == "MESH" and random.random() < 0.15:
        copies(item, random)
    if item.type == "MESH" and random.random() < 0.08:
        scattered(item, random)
    return item
