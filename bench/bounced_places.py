# SPDX-License-Identifier: GPL-3.0-or-later
"""Places that bounces light, as the scenes of scenes.py: a room behind a window, a still life that is not still, a forest
and a head of hair.

Motion as in bounced_scenes.py.
"""

import math

import bpy
import numpy as np
from bounced_scenes import WHITE, ball, matte, polygons
from lit_scenes import checker, glossy, lamp, plane, textured, world
from scenes import add, add_camera, animate, empty, material, pixel

WIDTH = 256


def window():
    """A room four metres wide, lit through a window of one and a half by one by the sun and the sky."""
    scene = empty(WIDTH)
    x, y, z = (-2.0, 2.0), (-1.3, 1.3), (-3.0, 2.0)
    corners = [(a, b, c) for c in z for b in y for a in x]
    for name, face, color in (
        ("Floor", (0, 1, 5, 4), (0.4, 0.25, 0.15)),
        ("Ceiling", (2, 6, 7, 3), WHITE),
        ("Back", (0, 2, 3, 1), WHITE),
        ("Front", (4, 5, 7, 6), WHITE),
        ("Left", (0, 4, 6, 2), (0.3, 0.45, 0.6)),
    ):
        polygons(scene, name, corners, [face], matte(name, color))
    # The right wall around its window.
    ring = [(y[0], z[0]), (y[1], z[0]), (y[1], z[1]), (y[0], z[1])]
    ring += [(-0.3, -1.2), (0.9, -1.2), (0.9, 0.3), (-0.3, 0.3)]
    faces = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    polygons(scene, "Right", [(x[1], *point) for point in ring], faces, matte("Right", WHITE))
    ball(scene, matte("Ball", WHITE), 0.6).location = (-0.5, -0.7, -1.2)
    polygons(
        scene,
        "Table",
        [(0.2, -0.6, -2), (1.2, -0.6, -2), (1.2, -0.6, -1), (0.2, -0.6, -1)],
        [(0, 3, 2, 1)],
        matte("Table", (0.5, 0.1, 0.08)),
    )
    lamp(scene, "SUN", 6.0, rotation=(0.2, 0.9, 0), angle=0.01)
    world(scene, 2.0)
    add_camera(scene, (-0.6, 0, 1.9), focal=22)
    scene.frame_set(1)
    return scene


def still_life():
    """Balls of metal, glass and clay on a checkered board, under a lamp and a sky; the camera moves by 10 pixels."""
    scene = empty(WIDTH)
    plane(scene, "Board", textured("Board", checker(2.0)), 6.0, (0, 0, 0))
    ball(scene, glossy("Metal", (0.9, 0.7, 0.4), 0.15), 0.8).location = (-1.2, 0.2, 0.8)
    glass = material("Glass", "ShaderNodeBsdfGlass", (1, 1, 1))
    ball(scene, glass, 0.7).location = (0.5, -0.6, 0.7)
    ball(scene, matte("Clay", (0.6, 0.2, 0.15)), 0.5).location = (1.5, 0.8, 0.5)
    ball(scene, glossy("Mirror", (0.9, 0.9, 0.9), 0.0), 0.4).location = (0.2, 1.4, 0.4)
    lamp(scene, "AREA", 300, (-3, -2, 5), (-0.35, -0.45, 0), size=1.5)
    world(scene, 0.4)
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    camera = add_camera(scene, (0, -5.5, 3.2), focal=45, tilt=math.radians(62))
    # Ten pixels six metres away.
    animate(camera, "location", 0, 10 * 6 * 36 / 45 / WIDTH)
    scene.frame_set(1)
    return scene


def tree(leaves, seed):
    """A crown of leaves, each a square of two triangles' worth, around a trunk of six sides."""
    random = np.random.default_rng(seed)
    centers = random.normal(size=(leaves, 3))
    centers *= (random.uniform(0, 1, leaves) ** 0.4 / np.linalg.norm(centers, axis=1))[:, None]
    centers = centers * (1.0, 1.0, 1.3) + (0, 0, 2.3)
    sides = np.stack([np.linalg.qr(m)[0].T for m in random.normal(size=(leaves, 3, 2))]) * 0.05
    points = centers[:, None] + np.stack(
        [
            -sides[:, 0] - sides[:, 1],
            sides[:, 0] - sides[:, 1],
            sides.sum(1),
            sides[:, 1] - sides[:, 0],
        ],
        1,
    )
    mesh = bpy.data.meshes.new("Tree")
    angles = np.arange(6) * math.pi / 3
    trunk = [(0.1 * math.cos(a), 0.1 * math.sin(a), z) for z in (0, 2) for a in angles]
    faces = (np.arange(4 * leaves).reshape(-1, 4)).tolist()
    faces += [
        (4 * leaves + np.array((i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i))).tolist() for i in range(6)
    ]
    mesh.from_pydata(points.reshape(-1, 3).tolist() + trunk, [], faces)
    mesh.materials.append(leaf())
    mesh.materials.append(matte("Bark", (0.2, 0.12, 0.07)))
    mesh.polygons.foreach_set("material_index", [0] * leaves + [1] * 6)
    return mesh


def leaf():
    """Half of its light goes through."""

    def both(nodes, shader):
        through = nodes.nodes.new("ShaderNodeBsdfTranslucent")
        through.inputs["Color"].default_value = (0.3, 0.5, 0.05, 1)
        mix = nodes.nodes.new("ShaderNodeMixShader")
        nodes.links.new(shader.outputs[0], mix.inputs[1])
        nodes.links.new(through.outputs[0], mix.inputs[2])
        return mix.outputs[0]

    return material("Leaf", "ShaderNodeBsdfDiffuse", (0.1, 0.35, 0.05), both)


def forest():
    """2,000 trees of 8,000 leaves under a sun and a sky."""
    scene = empty(WIDTH)
    random = np.random.default_rng(12)
    shapes = [tree(8000, seed) for seed in range(3)]
    plane(scene, "Ground", matte("Ground", (0.25, 0.2, 0.1)), 80.0, (0, 40, 0))
    for i in range(2000):
        place = (*random.uniform((-45, -2), (45, 80)), 0)
        thing = add(scene, f"Tree {i}", shapes[i % 3], place)
        thing.rotation_euler.z = random.uniform(0, 6)
        thing.scale = (random.uniform(0.7, 1.3),) * 3
    lamp(scene, "SUN", 3.0, rotation=(0.7, 0.4, 0), angle=0.01)
    world(scene, 0.8)
    add_camera(scene, (0, -14, 7), focal=35, tilt=math.radians(78))
    scene.frame_set(1)
    return scene


def head():
    """A ball with 20,000 straight hairs, a pixel wide, under a soft lamp and a sky; the camera moves by 10 pixels.  Hair
    that grows by chance, or on what is keyed, lies elsewhere in each process: its reference would be of other hair."""
    scene = empty(WIDTH)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=2.5)
    thing = bpy.context.object
    thing.data.materials.append(matte("Hair", (0.5, 0.3, 0.15)))
    thing.modifiers.new("Hair", "PARTICLE_SYSTEM")
    hair = thing.particle_systems[0].settings
    hair.type, hair.count, hair.hair_length, hair.render_step = "HAIR", 20_000, 1.2, 3
    hair.root_radius, hair.tip_radius, hair.radius_scale = pixel(scene), 0.3 * pixel(scene), 1.0
    lamp(scene, "AREA", 900, (-6, 2, 8), (-0.2, -0.6, 0), size=4.0)
    world(scene, 0.5)
    camera = add_camera(scene, (0, -6, 16), focal=45, tilt=0.35)
    animate(camera, "location", 0, 10 * 17 * 36 / 45 / WIDTH)
    scene.frame_set(1)
    return scene


SCENES = {f.__name__: f for f in (window, still_life, forest, head)}
