# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of the benches, built inside Blender so that every engine renders the same ones.

Each builder starts from an empty file, moves things linearly through frames 0 to 2 and returns the scene at frame 1;
a shutter of half a frame from there sees the motion that the builder's docstring names, in pixels of its own frame.
Colours glow where lighting is not the point.  Frames are 16 to 9, as large as a reference can be had for in minutes.
"""

import math
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "demo"))
from keyframes import make_linear  # noqa: E402

SHUTTER = 0.5
SCALE = 16.0  # metres across the frame, where the camera is orthographic


def empty(width):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0, 0, 0)
    scene.render.resolution_x, scene.render.resolution_y = width, width * 9 // 16
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.cycles_curves.shape = "RIBBONS"
    return scene


def pixel(scene):
    """Metres, where the camera is orthographic."""
    return SCALE / scene.render.resolution_x


def add(scene, name, data, location=(0, 0, 0), parent=None):
    item = bpy.data.objects.new(name, data)
    item.location, item.parent = location, parent
    scene.collection.objects.link(item)
    return item


def animate(item, path, index, change):
    """`change` over the shutter, linear and centred on its middle, on top of what is there."""
    rest = getattr(item, path)[index]
    for frame in (0, 2):
        getattr(item, path)[index] = rest + change * ((frame - 1) / SHUTTER - 0.5)
        item.keyframe_insert(path, index=index, frame=frame)
    make_linear(item)


def add_camera(scene, location, focal=None, tilt=0.0):
    """Lookups down -z, tilted about x by radians; orthographic without a focal length (mm)."""
    data = bpy.data.cameras.new("Camera")
    if focal is None:
        data.type, data.ortho_scale = "ORTHO", SCALE
    else:
        data.lens = focal
    scene.camera = add(scene, "Camera", data, location)
    scene.camera.rotation_euler.x = tilt
    return scene.camera


def material(name, shader, color, build=None):
    """One shader node of a colour; `build(tree, shader node)` may put another between it and the output."""
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(shader)
    node.inputs["Color"].default_value = (*color, 1)
    surface = build(tree, node) if build else node.outputs[0]
    tree.links.new(surface, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return result


def sphere_mesh(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1)
    ball = bpy.context.object
    mesh = ball.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    bpy.data.objects.remove(ball)
    return mesh


def add_spheres(scene, shader, parent, low, high, count=60):
    """Seeded places between two corners, six colours."""
    random = np.random.default_rng(5)
    mesh = sphere_mesh(scene)
    colors = [material(f"Colour {i}", shader, random.uniform(0.05, 1, 3)) for i in range(6)]
    for i in range(count):
        copy = mesh.copy()
        copy.materials.append(colors[i % 6])
        ball = add(scene, f"Ball {i}", copy, random.uniform(low, high), parent)
        ball.scale = (random.uniform(0.3, 1.1),) * 3


def spheres(pixels=20):
    """60 spheres that glow and move to the right, 20 pixels."""
    scene = empty(960)
    mover = add(scene, "Mover", None)
    add_spheres(scene, "ShaderNodeEmission", mover, (-7, -4, -5), (7, 4, 5))
    if pixels:
        animate(mover, "location", 0, pixels * pixel(scene))
    add_camera(scene, (0, 0, 20))
    scene.frame_set(1)
    return scene


def add_open_lens(scene):
    """A camera at 24 m, focused on the origin, whose circles of confusion reach a radius of 8 pixels 8 m before it."""
    dof = add_camera(scene, (0, 0, 24), focal=50).data.dof
    dof.use_dof, dof.focus_distance = True, 24.0
    # At depth z the radius is (focal / fstop / 2) |1 / z - 1 / 24| width focal / sensor.
    radius = 8 / (abs(1 / 16 - 1 / 24) * scene.render.resolution_x * 50 / 36)
    dof.aperture_fstop = 0.05 / (2 * radius)


def lens():
    """The same through a lens whose circles of confusion reach a radius of 8 pixels."""
    scene = empty(960)
    mover = add(scene, "Mover", None)
    add_spheres(scene, "ShaderNodeEmission", mover, (-7, -4, -8), (7, 4, 8))
    animate(mover, "location", 0, 20 * pixel(scene))
    add_open_lens(scene)
    scene.frame_set(1)
    return scene


def lit():
    """Spheres on a floor under a sun and an area lamp; lights and casters are still, the camera moves 10 pixels."""
    scene = empty(640)
    add_spheres(scene, "ShaderNodeBsdfDiffuse", None, (-7, -4, 0), (7, 4, 2), 30)
    floor = bpy.data.meshes.new("Floor")
    floor.from_pydata([(-30, -30, -1), (30, -30, -1), (30, 30, -1), (-30, 30, -1)], [], [range(4)])
    floor.materials.append(material("Floor", "ShaderNodeBsdfDiffuse", (0.6, 0.6, 0.6)))
    add(scene, "Floor", floor)
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 1.0, 0.05
    add(scene, "Sun", sun).rotation_euler = (0.5, 0.4, 0)
    area = bpy.data.lights.new("Area", "AREA")
    area.energy, area.size = 900, 3.0
    add(scene, "Area", area, (-5, 3, 9)).rotation_euler = (-0.3, -0.5, 0)
    animate(add_camera(scene, (0, -8, 18), focal=45, tilt=0.4), "location", 0, 10 * pixel(scene))
    scene.frame_set(1)
    return scene


def feather_material(name, color):
    """Opacity goes in waves along the feather, .15 to .75."""

    def see_through(tree, emission):
        coordinate = tree.nodes.new("ShaderNodeTexCoord")
        split = tree.nodes.new("ShaderNodeSeparateXYZ")
        tree.links.new(coordinate.outputs["UV"], split.inputs[0])
        value = split.outputs["Y"]
        for operation, factor in (
            ("MULTIPLY", 38.0),
            ("SINE", 0),
            ("MULTIPLY", 0.3),
            ("ADD", 0.45),
        ):
            node = tree.nodes.new("ShaderNodeMath")
            node.operation = operation
            tree.links.new(value, node.inputs[0])
            node.inputs[1].default_value = factor
            value = node.outputs[0]
        mix = tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(value, mix.inputs["Fac"])
        clear = tree.nodes.new("ShaderNodeBsdfTransparent")
        tree.links.new(clear.outputs[0], mix.inputs[1])
        tree.links.new(emission.outputs[0], mix.inputs[2])
        return mix.outputs[0]

    return material(name, "ShaderNodeEmission", color, see_through)


def feather_mesh(name, random, count, spread):
    """`count` strips, 4 by .8 metres (80 by 16 pixels), bent along their length only, so that their faces are flat."""
    across, along = 2, 12
    u, v = np.meshgrid(np.linspace(0, 1, across + 1), np.linspace(0, 1, along + 1))
    points, faces, uvs = [], [], []
    cell = np.array([0, 1, across + 2, across + 1])
    cells = (np.arange(along)[:, None] * (across + 1) + np.arange(across)).reshape(-1, 1) + cell
    for _ in range(count):
        angle, bend = random.uniform(0, 2 * math.pi), random.uniform(0.2, 1)
        x, y = 0.8 * (u - 0.5), 4.0 * (v - 0.5)
        z = bend * np.sin(math.pi * v)
        place = random.uniform(-spread, spread)
        turned = (
            x * math.cos(angle) - y * math.sin(angle) + place[0],
            x * math.sin(angle) + y * math.cos(angle) + place[1],
            z + place[2],
        )
        faces.append(cells + len(points) * u.size)
        points.append(np.stack(turned, -1).reshape(-1, 3))
        uvs.append(np.stack([u, v], -1).reshape(-1, 2)[cells].reshape(-1, 2))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.concatenate(points).tolist(), [], np.concatenate(faces).tolist())
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", np.concatenate(uvs).ravel())
    return mesh


def feathers(moving=True):
    """400 half-transparent feathers in ten bunches; each bunch turns by .5, 20 pixels at 40 from its middle."""
    scene = empty(320)
    random = np.random.default_rng(7)
    for i in range(10):
        mesh = feather_mesh(f"Bunch {i}", random, 40, np.array([2.5, 2.0, 1.0]))
        mesh.materials.append(feather_material(f"Feather {i}", random.uniform(0.1, 1, 3)))
        place = (*random.uniform((-5, -2), (5, 2)), random.uniform(-4, 4))
        bunch = add(scene, f"Bunch {i}", mesh, place)
        if moving:
            animate(bunch, "rotation_euler", 2, 0.5 * (-1) ** i)
    add_camera(scene, (0, 0, 20))
    scene.frame_set(1)
    return scene


def grass():
    """1,500 blades of hair, 2 pixels wide at the root, on sixty clods that sway: 20 pixels at the tips."""
    scene = empty(480)
    random = np.random.default_rng(11)
    for i in range(60):
        color = random.uniform((0.05, 0.2, 0.02), (0.5, 0.8, 0.2))
        mesh = bpy.data.meshes.new(f"Clod {i}")
        mesh.from_pydata(
            [(-0.7, -0.7, 0), (0.7, -0.7, 0), (0.7, 0.7, 0), (-0.7, 0.7, 0)], [], [range(4)]
        )
        mesh.materials.append(material(f"Grass {i}", "ShaderNodeEmission", color))
        clod = add(scene, f"Clod {i}", mesh, (1.5 * (i % 10) - 6.75, 1.5 * (i // 10), 0))
        clod.modifiers.new("Grass", "PARTICLE_SYSTEM")
        clod.particle_systems[0].seed = i
        hair = clod.particle_systems[0].settings
        hair.type, hair.count, hair.hair_length, hair.render_step = "HAIR", 25, 2.0, 3
        hair.brownian_factor = 0.1
        px = pixel(scene)
        hair.root_radius, hair.tip_radius, hair.radius_scale = 2 * px, 0.3 * px, 1.0
        animate(clod, "rotation_euler", 1, 8 * px * (-1) ** i)
    add_camera(scene, (0, -9, 8), focal=36, tilt=0.95)
    scene.frame_set(1)
    return scene


SCENES = {s.__name__: s for s in (spheres, lens, lit, feathers, grass)}
