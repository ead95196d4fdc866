# SPDX-License-Identifier: GPL-3.0-or-later
"""Any artist's file as a scene for the benches: .blend, .glb, .gltf, .obj, and .hdr or .exr as a sky over surfaces.  Runs inside Blender.

What a file lacks is given to it: a camera before the bounds of what it shows, a floor below them, a sun and a grey world.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

HERE = Path(__file__).resolve().parent
for folder in ("blender", "images"):
    sys.path.insert(0, str(HERE.parent / "tests" / folder))
import engines  # noqa: E402
import scene_parts  # noqa: E402

if "bool" not in vars(np):
    np.bool = bool  # the glTF importer of Blender 3.4 asks for it

DRAWN = ("MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD")


def material(name, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    for socket, value in inputs.items():
        made.node_tree.nodes["Principled BSDF"].inputs[
            socket.replace("_", " ")
        ].default_value = value
    return made


def surfaces():
    """A row of balls of kinds that show a sky in different ways."""
    glass = "Transmission" if bpy.app.version < (4, 0) else "Transmission_Weight"
    kinds = (
        material("Plaster", Roughness=1.0),
        material("Plastic", Base_Color=(0.6, 0.05, 0.03, 1), Roughness=0.3),
        material("Chrome", Metallic=1.0, Roughness=0.05),
        material("Brass", Base_Color=(0.8, 0.5, 0.2, 1), Metallic=1.0, Roughness=0.35),
        material("Glass", Roughness=0.0, **{glass: 1.0}),
    )
    for i, kind in enumerate(kinds):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=64, ring_count=32, location=(2.2 * (i - 2), 0, 1)
        )
        bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(kind)


def sky(path):
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    image = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(str(path))
    world.node_tree.links.new(
        image.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"]
    )
    return world


def grey():
    world = bpy.data.worlds.new("Grey")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.25, 0.3, 1)
    return world


def bounds(scene):
    """(lowest, highest corner) in world space of what is drawn."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    corners = [
        item.matrix_world @ Vector(corner)
        for item in (each.object for each in depsgraph.object_instances)
        if item.type in DRAWN
        for corner in item.bound_box
    ]
    values = np.array(corners) if corners else np.array([[-1.0] * 3, [1.0] * 3])
    return values.min(0), values.max(0)


def complete(scene):
    """Without operators, which files in other modes refuse."""
    low, high = bounds(scene)
    size, middle = float(np.linalg.norm(high - low)), (low + high) / 2
    if scene.world is None:
        scene.world = grey()
    shines = any(item.type == "LIGHT" for item in scene.objects)
    if scene.camera is not None:
        return
    place = (middle[0], middle[1], low[2] - 1e-4 * size)
    scene_parts.add_square(scene, "Floor", 20 * size, place, material("Floor", Roughness=0.8))
    engines.add_camera(scene, middle + np.array((0.9, -1.5, 0.6)) * size * 0.8, middle)
    if not shines:
        sun = scene_parts.add_object(scene, "Sun", bpy.data.lights.new("Sun", "SUN"))
        sun.rotation_euler = 0.7, 0.3, 0.5
        sun.data.energy, sun.data.angle = 2.0, 0.05


def build(path):
    """(scene, its frame, no shutter)"""
    kind = Path(path).suffix.lower()
    if kind == ".blend":
        bpy.ops.wm.open_mainfile(filepath=path)
    else:
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        if kind in (".glb", ".gltf"):
            bpy.ops.import_scene.gltf(filepath=path)
        elif kind == ".obj":
            bpy.ops.wm.obj_import(filepath=path)
        else:
            surfaces()
    scene = bpy.context.scene
    if kind in (".hdr", ".exr"):
        scene.world = sky(path)
    complete(scene)
    render = scene.render
    render.threads_mode, render.threads = "FIXED", 1
    render.use_border = render.use_compositing = render.use_sequencer = False
    render.film_transparent = False
    return scene, scene.frame_current, 0.0
