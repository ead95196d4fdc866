# SPDX-License-Identifier: GPL-3.0-or-later
"""What the probes' scenes are made of, so that things show: curved, coloured, lit, casting shadows."""

import bpy
import numpy as np
import scene_parts


def surface(scene, name="Surface", columns=10, size=2.4, height=0.3, material=None):
    """A smooth cushion of triangles over the frame with UVs, a colour and the attribute "A"."""
    n = columns + 1
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    z = height * np.cos(1.2 * x) * np.cos(1.4 * y)
    points = np.stack([x * size / 2, y * size / 2, z], axis=-1).reshape(-1, 3)
    faces = []
    for j in range(columns):
        for i in range(columns):
            a = j * n + i
            faces += [(a, a + 1, a + n + 1), (a, a + n + 1, a + n)]
    thing = scene_parts.add_mesh(scene, name, points.tolist(), faces, material=material)
    finish_mesh(thing.data)
    return thing


def finish_mesh(mesh):
    """Smooth, with the UV map "UVMap", the colour "Col" and the attribute "A", all varying over x and y."""
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    corner = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corner)
    low, high = points.min(axis=0), points.max(axis=0)
    unit = (points - low) / np.maximum(high - low, 1e-6)
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", unit[corner, :2].ravel())
    color = np.ones((len(points), 4), dtype=np.float32)
    color[:, :3] = 0.2 + 0.6 * unit[:, [1, 0, 1]]
    mesh.color_attributes.new("Col", "FLOAT_COLOR", "POINT").data.foreach_set(
        "color", color.ravel()
    )
    values = (0.9 - 0.7 * unit[:, [0, 1, 0]]).astype(np.float32)
    mesh.attributes.new("A", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", values.ravel())
    mesh.update()


def show_sum(tree, first, second, part=0.5):
    """A tree of `scene_parts.node_material` shows `part` of one output and all of another, diffuse."""
    _made, nodes, links, output = tree
    add, shader = nodes.new("ShaderNodeVectorMath"), nodes.new("ShaderNodeBsdfDiffuse")
    add.operation = "MULTIPLY_ADD"
    links.new(first, add.inputs[0])
    add.inputs[1].default_value = (part,) * 3
    links.new(second, add.inputs[2])
    links.new(add.outputs[0], shader.inputs["Color"])
    links.new(shader.outputs[0], output.inputs["Surface"])


def diffuse(name, color):
    return scene_parts.closure(name, "ShaderNodeBsdfDiffuse", Color=(*color, 1.0))


def glowing(name, source="Generated"):
    """Emits its texture coordinate: places, UVs and normals show without light."""
    made, nodes, links, output = scene_parts.node_material(name)
    coordinate, emit = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeEmission")
    links.new(coordinate.outputs[source], emit.inputs["Color"])
    links.new(emit.outputs[0], output.inputs["Surface"])
    return made


def add_sun(scene, angle=0.0, strength=2.0, tilt=(0.5, 0.3, 0.0)):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = strength, angle
    thing = scene_parts.add_object(scene, "Sun", light)
    thing.rotation_euler = tilt
    return thing


def set_world(scene, color=(0.0, 0.0, 0.0), strength=1.0):
    world = scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength
    return world


def add_cube(scene, name="Cube", size=0.8, location=(0.0, 0.0, 0.5), material=None, turn=0.4):
    h = size / 2
    corners = [(x, y, z) for z in (-h, h) for y in (-h, h) for x in (-h, h)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    thing = scene_parts.add_mesh(scene, name, corners, faces, location, material)
    thing.rotation_euler = (turn, 0.7 * turn, turn)
    return thing


def add_floor(scene, material=None, z=-0.4):
    return scene_parts.add_square(
        scene, "Floor", 6.0, (0, 0, z), material or diffuse("Floor", (0.6, 0.5, 0.4))
    )


def camera(scene, distance=4.0, lens=50.0):
    """A perspective camera that looks down."""
    thing = scene_parts.add_camera(scene, (0, 0, distance))
    thing.data.lens = lens
    return thing


def top_camera(scene, scale=2.0):
    return scene_parts.add_camera(scene, (0, 0, 5), ortho_scale=scale)


def move(thing, distance=0.5, axis=0):
    """Along x, through its place at frame 1, half a metre a frame."""
    start = thing.location[axis]
    for frame in (0, 2):
        thing.location[axis] = start + distance * (frame - 1)
        thing.keyframe_insert("location", index=axis, frame=frame)
    scene_parts.make_linear(thing)
    thing.location[axis] = start
