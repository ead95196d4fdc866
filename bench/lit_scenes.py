# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit scenes of the benches, as those of scenes.py: where shading, not visibility, is what has to converge.

Linear motion through frames 0 to 2, seen by a shutter of half a frame from frame 1 on; no bounces.
"""

import bpy
import numpy as np
from scenes import add, add_camera, add_open_lens, add_spheres, animate, empty, material, pixel

WIDTH = 480


def textured(name, build):
    """Diffuse of what `build(tree)` returns as colour."""

    def color(tree, shader):
        tree.links.new(build(tree), shader.inputs["Color"])
        return shader.outputs[0]

    return material(name, "ShaderNodeBsdfDiffuse", (1, 1, 1), color)


def checker(scale):
    def build(tree):
        node = tree.nodes.new("ShaderNodeTexChecker")
        node.inputs["Scale"].default_value = scale
        node.inputs["Color1"].default_value = (0.7, 0.65, 0.55, 1)
        node.inputs["Color2"].default_value = (0.15, 0.2, 0.3, 1)
        coordinate = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinate.outputs["Object"], node.inputs["Vector"])
        return node.outputs["Color"]

    return build


def noise(scale):
    def build(tree):
        node = tree.nodes.new("ShaderNodeTexNoise")
        node.inputs["Scale"].default_value = scale
        node.inputs["Detail"].default_value = 4.0
        coordinate = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinate.outputs["Object"], node.inputs["Vector"])
        return node.outputs["Color"]

    return build


def glossy(name, color, roughness):
    result = material(name, "ShaderNodeBsdfGlossy", color)
    node = next(n for n in result.node_tree.nodes if n.type == "BSDF_GLOSSY")
    node.distribution = "GGX"
    node.inputs["Roughness"].default_value = roughness
    return result


def plane(scene, name, shader, size=30.0, location=(0, 0, -1)):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(
        [(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)], [], [range(4)]
    )
    mesh.materials.append(shader)
    return add(scene, name, mesh, location)


def diffuse_floor(scene, color, height=-1):
    """Of one colour."""
    shader = material("Floor", "ShaderNodeBsdfDiffuse", color)
    return plane(scene, "Floor", shader, location=(0, 0, height))


def lamp(scene, kind, energy, location=(0, 0, 0), rotation=(0, 0, 0), **settings):
    light = bpy.data.lights.new(kind.title(), kind)
    light.energy = energy
    for name, value in settings.items():
        setattr(light, name, value)
    item = add(scene, kind.title(), light, location)
    item.rotation_euler = rotation
    return item


def world(scene, strength):
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.6, 0.75, 1.0, 1)
    background.inputs["Strength"].default_value = strength


def stage(parent=None):
    """Spheres under a sun, a small area lamp and a world, over a checkered floor."""
    scene = empty(WIDTH)
    add_spheres(
        scene, "ShaderNodeBsdfDiffuse", parent and parent(scene), (-7, -4, 0), (7, 4, 2), 30
    )
    plane(scene, "Floor", textured("Floor", checker(0.7)))
    lamp(scene, "SUN", 1.0, rotation=(0.5, 0.4, 0), angle=0.01)
    lamp(scene, "AREA", 500, (-5, 3, 9), (-0.3, -0.5, 0), size=0.5)
    world(scene, 0.2)
    return scene


def still():
    """Nothing moves."""
    scene = stage()
    add_camera(scene, (0, -8, 18), focal=45, tilt=0.4)
    return scene


def moving():
    """Camera and casters move, 10 pixels against each other."""
    mover = []

    def parent(scene):
        mover.append(add(scene, "Mover", None))
        return mover[0]

    scene = stage(parent)
    animate(mover[0], "location", 1, 10 * pixel(scene))
    animate(add_camera(scene, (0, -8, 18), focal=45, tilt=0.4), "location", 0, 10 * pixel(scene))
    scene.frame_set(1)
    return scene


def turning():
    """Five heads turn by a quarter radian under a sun and a large area lamp."""
    scene = empty(WIDTH)
    shader = textured("Skin", noise(2.0))
    for i in range(5):
        bpy.ops.mesh.primitive_monkey_add(size=3)
        head = bpy.context.object
        head.location = (3.2 * (i - 2), 0, 0.6)
        head.data.polygons.foreach_set("use_smooth", [True] * len(head.data.polygons))
        # Applied: of a modifier Granita has the limit surface and Cycles polygons, another shape.
        head.modifiers.new("Subdivision", "SUBSURF").levels = 2
        bpy.ops.object.modifier_apply(modifier="Subdivision")
        head.data.materials.append(shader)
        animate(head, "rotation_euler", 2, 0.25 * (-1) ** i)
    diffuse_floor(scene, (0.6, 0.6, 0.6))
    lamp(scene, "SUN", 2.0, rotation=(0.7, 0.5, 0), angle=0.01)
    lamp(scene, "AREA", 800, (6, -6, 6), (0.8, 0.5, 0), size=4.0)
    add_camera(scene, (0, -16, 7), focal=45, tilt=1.18)
    scene.frame_set(1)
    return scene


def sweep():
    """The sharp shadows of bars sweep 20 pixels over a still floor with spheres on it."""
    scene = empty(WIDTH)
    mover = add(scene, "Mover", None)
    bar = bpy.data.meshes.new("Bar")
    bar.from_pydata([(-0.3, -9, 0), (0.3, -9, 0), (0.3, 9, 0), (-0.3, 9, 0)], [], [range(4)])
    bar.materials.append(material("Bar", "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5)))
    for i in range(6):
        add(scene, f"Bar {i}", bar, (-12.5 + 2.5 * i, 0, 6), mover)
    animate(mover, "location", 0, 20 * pixel(scene))
    add_spheres(scene, "ShaderNodeBsdfDiffuse", None, (-7, -4, -0.8), (7, 4, 0), 20)
    diffuse_floor(scene, (0.7, 0.7, 0.7))
    lamp(scene, "SUN", 2.0, rotation=(0, -0.9, 0), angle=0.0)
    add_camera(scene, (0, -6, 16), focal=40, tilt=0.35)
    scene.frame_set(1)
    return scene


def slide():
    """A checkered floor slides 20 pixels under the fixed shadows of spheres."""
    scene = empty(WIDTH)
    floor = plane(scene, "Floor", textured("Floor", checker(0.7)))
    animate(floor, "location", 0, 20 * pixel(scene))
    add_spheres(scene, "ShaderNodeBsdfDiffuse", None, (-7, -4, 0.5), (7, 4, 2), 20)
    lamp(scene, "SUN", 2.0, rotation=(0.6, 0.4, 0), angle=0.0)
    world(scene, 0.2)
    add_camera(scene, (0, -6, 16), focal=40, tilt=0.35)
    scene.frame_set(1)
    return scene


def bolt():
    """Metal prisms that turn by .2 under small area lamps: highlights flash over their faces."""
    scene = empty(WIDTH)
    metal = glossy("Metal", (0.9, 0.8, 0.6), 0.25)
    random = np.random.default_rng(3)
    for i in range(12):
        bpy.ops.mesh.primitive_cylinder_add(vertices=6 + i % 3 * 13, radius=0.9, depth=2.5)
        thing = bpy.context.object
        if i % 3:
            thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))
        thing.location = (2.5 * (i % 6) - 6.2, 3.2 * (i // 6) - 1.6, 0)
        thing.rotation_euler = random.uniform(0, 3, 3)
        thing.data.materials.append(metal)
        animate(thing, "rotation_euler", 2, 0.2 * (-1) ** i)
    plane(scene, "Floor", glossy("Floor", (0.4, 0.4, 0.4), 0.4), location=(0, 0, -2))
    for x in (-6, 0, 6):
        lamp(scene, "AREA", 150, (x, -3, 6), (0.4, 0, 0), size=0.7)
    world(scene, 0.1)
    add_camera(scene, (0, 0, 20))
    scene.frame_set(1)
    return scene


def bright(scene, count=60):
    """Glossy spheres in front of and behind the focus, small lamps."""
    mover = add(scene, "Mover", None)
    add_spheres(scene, "ShaderNodeBsdfGlossy", mover, (-7, -4, -8), (7, 4, 8), count)
    for shader in bpy.data.materials:
        for node in shader.node_tree.nodes:
            if node.type == "BSDF_GLOSSY":
                node.distribution, node.inputs["Roughness"].default_value = "GGX", 0.3
    return mover


def bokeh():
    """Highlights of spheres through a lens whose circles reach a radius of 8 pixels; they move by 10."""
    scene = empty(WIDTH)
    animate(bright(scene), "location", 0, 10 * pixel(scene))
    for x in (-8, 8):
        lamp(scene, "AREA", 1500, (x, 6, 14), (-0.4, 0.03 * x, 0), size=1.0)
    world(scene, 0.1)
    add_open_lens(scene)
    scene.frame_set(1)
    return scene


def wall():
    """The camera moves 40 pixels along a lit wall of fine texture."""
    scene = empty(WIDTH)
    wall = plane(scene, "Wall", textured("Wall", noise(3.0)), location=(0, 0, 0))
    wall.rotation_euler = (0.3, 0, 0)
    add_spheres(scene, "ShaderNodeBsdfDiffuse", None, (-7, -4, 0), (7, 4, 2), 10)
    lamp(scene, "SUN", 2.0, rotation=(0.5, 0.6, 0), angle=0.02)
    animate(add_camera(scene, (0, 0, 20), focal=45), "location", 0, 40 * pixel(scene))
    scene.frame_set(1)
    return scene


def leaves():
    """Leaves cut out of squares by their texture, swaying, under a sun and a world."""
    scene = empty(WIDTH)
    random = np.random.default_rng(9)

    def cut_out(tree, shader):
        coordinate = tree.nodes.new("ShaderNodeTexCoord")
        gradient = tree.nodes.new("ShaderNodeTexGradient")
        gradient.gradient_type = "SPHERICAL"
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Location"].default_value = (-2.0, -1.0, 0)
        mapping.inputs["Scale"].default_value = (4.0, 2.0, 1)
        tree.links.new(coordinate.outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs[0], gradient.inputs[0])
        step = tree.nodes.new("ShaderNodeMath")
        step.operation = "GREATER_THAN"
        step.inputs[1].default_value = 0.05
        tree.links.new(gradient.outputs["Fac"], step.inputs[0])
        mix = tree.nodes.new("ShaderNodeMixShader")
        clear = tree.nodes.new("ShaderNodeBsdfTransparent")
        tree.links.new(step.outputs[0], mix.inputs["Fac"])
        tree.links.new(clear.outputs[0], mix.inputs[1])
        tree.links.new(shader.outputs[0], mix.inputs[2])
        return mix.outputs[0]

    shader = material("Leaf", "ShaderNodeBsdfDiffuse", (0.2, 0.5, 0.1), cut_out)
    for i in range(6):
        points, faces, uvs = [], [], []
        for k in range(60):
            center = random.uniform((-2.5, -2.5, -1), (2.5, 2.5, 1))
            a, b = np.linalg.qr(random.normal(size=(3, 2)))[0].T * random.uniform(0.4, 0.8)
            points += [
                tuple(center + s * a + t * b) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ]
            faces.append(tuple(range(4 * k, 4 * k + 4)))
            uvs += [(0, 0), (1, 0), (1, 1), (0, 1)]
        mesh = bpy.data.meshes.new(f"Twig {i}")
        mesh.from_pydata(points, [], faces)
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", np.ravel(uvs))
        mesh.materials.append(shader)
        twig = add(
            scene, f"Twig {i}", mesh, (*random.uniform((-5, -2.5), (5, 2.5)), random.uniform(0, 3))
        )
        animate(twig, "rotation_euler", 2, 0.05 * (-1) ** i)
    diffuse_floor(scene, (0.5, 0.4, 0.3), -2)
    lamp(scene, "SUN", 3.0, rotation=(0.5, 0.3, 0), angle=0.01)
    world(scene, 0.3)
    scene.cycles.transparent_max_bounces = 64
    add_camera(scene, (0, 0, 20))
    scene.frame_set(1)
    return scene


def ball_mesh(radius, across=32, rings=16):
    """Blender's own has its faces in another order in each process, and hair grows by that."""
    down, around = np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(across) / across
    ring = np.stack([np.cos(around), np.sin(around), np.zeros(across)], -1)
    points = np.sin(down)[:, None, None] * ring
    points[..., 2] = np.cos(down)[:, None]
    points = radius * np.vstack([points.reshape(-1, 3), [(0, 0, 1), (0, 0, -1)]])
    k = np.arange(across)
    quads = [
        np.stack([i + k, i + across + k, i + across + (k + 1) % across, i + (k + 1) % across], -1)
        for i in across * np.arange(rings - 2)
    ]
    last, pole = across * (rings - 2), len(points) - 2
    caps = [(pole, a, (a + 1) % across) for a in range(across)]
    caps += [(pole + 1, last + (a + 1) % across, last + a) for a in range(across)]
    mesh = bpy.data.meshes.new("Ball")
    mesh.from_pydata(points.tolist(), [], [*np.concatenate(quads).tolist(), *caps])
    return mesh


def fur():
    """4,000 hairs, 1.5 pixels wide, on a ball that turns under a sun and a large area lamp."""
    scene = empty(WIDTH)
    ball = add(scene, "Ball", ball_mesh(2.5))
    ball.data.materials.append(material("Fur", "ShaderNodeBsdfDiffuse", (0.6, 0.35, 0.15)))
    ball.modifiers.new("Fur", "PARTICLE_SYSTEM")
    hair = ball.particle_systems[0].settings
    hair.type, hair.count, hair.hair_length, hair.render_step = "HAIR", 4000, 1.5, 3
    hair.brownian_factor = 0.15
    px = pixel(scene)
    hair.root_radius, hair.tip_radius, hair.radius_scale = 1.5 * px, 0.3 * px, 1.0
    animate(ball, "rotation_euler", 2, 0.15)
    diffuse_floor(scene, (0.6, 0.6, 0.6), -3)
    lamp(scene, "SUN", 2.0, rotation=(0.6, 0.4, 0), angle=0.01)
    lamp(scene, "AREA", 900, (-6, 2, 8), (-0.2, -0.6, 0), size=4.0)
    add_camera(scene, (0, -6, 16), focal=45, tilt=0.35)
    scene.frame_set(1)
    return scene


SCENES = {
    s.__name__: s for s in (still, moving, turning, sweep, slide, bolt, bokeh, wall, leaves, fur)
}
