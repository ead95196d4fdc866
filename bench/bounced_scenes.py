# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms lit by what bounces, as the scenes of scenes.py: a box two metres wide, open to the camera, with a ball and a
block in it.

Linear motion through frames 0 to 2, seen by a shutter of half a frame from frame 1 on.
"""

import math

import bpy
from lit_scenes import glossy
from scenes import add, add_camera, animate, empty, material, pixel

SIZE = 256
WHITE, RED, GREEN = (0.73, 0.73, 0.73), (0.65, 0.05, 0.05), (0.12, 0.45, 0.15)
# Its corners, in the order of their numbers' bits: x, y, z.
CORNERS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
WALLS = {
    "Floor": ((0, 1, 5, 4), WHITE),
    "Ceiling": ((2, 6, 7, 3), WHITE),
    "Back": ((0, 2, 3, 1), WHITE),
    "Left": ((0, 4, 6, 2), RED),
    "Right": ((1, 3, 7, 5), GREEN),
}


def matte(name, color):
    return material(name, "ShaderNodeBsdfDiffuse", color)


def polygons(scene, name, points, faces, shader):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(shader)
    return add(scene, name, mesh)


def ball(scene, shader, radius=0.4, around=64, rings=32):
    """Smooth; the first and last ring are its poles' neighbours."""
    points = []
    for r in range(1, rings):
        height, across = math.cos(math.pi * r / rings), math.sin(math.pi * r / rings)
        for i in range(around):
            angle = 2 * math.pi * i / around
            points.append(
                (
                    radius * across * math.cos(angle),
                    radius * across * math.sin(angle),
                    radius * height,
                )
            )
    faces = [tuple(range(around)), tuple(reversed(range((rings - 2) * around, len(points))))]
    for r in range(rings - 2):
        for i in range(around):
            a, b = r * around + i, r * around + (i + 1) % around
            faces.append((a, a + around, b + around, b))
    thing = polygons(scene, "Ball", points, faces, shader)
    thing.data.polygons.foreach_set("use_smooth", [True] * len(faces))
    thing.location = (-0.4, -0.6, -0.3)
    return thing


def room(make, *look):
    """(scene, ball), still without a light; `make("Ball", *look)`: the ball's material."""
    scene = empty(SIZE)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    for name, (corners, color) in WALLS.items():
        polygons(scene, name, CORNERS, [corners], matte(name, color))
    block = polygons(
        scene,
        "Block",
        [tuple(0.3 * c for c in corner) for corner in CORNERS],
        [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)],
        matte("Block", WHITE),
    )
    block.location, block.rotation_euler = (0.35, -0.7, 0.2), (0.0, 0.3, 0.0)
    moved = ball(scene, make("Ball", *look))
    add_camera(scene, (0, 0, 3.6), focal=35)
    return scene, moved


def lamp(scene):
    light = bpy.data.lights.new("Lamp", "AREA")
    light.size, light.energy = 0.5, 20.0
    add(scene, "Lamp", light, (0, 0.99, 0)).rotation_euler.x = -math.pi / 2
    scene.frame_set(1)
    return scene


def still():
    """All diffuse."""
    return lamp(room(matte, WHITE)[0])


def metal():
    """A rough metal ball."""
    return lamp(room(glossy, (0.9, 0.9, 0.9), 0.3)[0])


def mirror():
    return lamp(room(glossy, (0.9, 0.9, 0.9), 0.0)[0])


def moving():
    """The ball goes 24 pixels aside, and the camera's lens is open."""
    scene, moved = room(matte, WHITE)
    animate(moved, "location", 0, 24 * pixel(scene))
    dof = scene.camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 3.3, 0.25
    return lamp(scene)


def shining():
    """The lamp is a square that shines."""
    scene, _ = room(matte, WHITE)
    emits = material("Shining", "ShaderNodeEmission", (1.0, 0.9, 0.7))
    emits.node_tree.nodes["Emission"].inputs["Strength"].default_value = 12.0
    h = 0.25
    corners = [(-h, 0.99, -h), (h, 0.99, -h), (h, 0.99, h), (-h, 0.99, h)]
    polygons(scene, "Shining", corners, [(0, 1, 2, 3)], emits)
    scene.frame_set(1)
    return scene


SCENES = {f.__name__: f for f in (still, metal, mirror, moving, shining)}
