# SPDX-License-Identifier: GPL-3.0-or-later
"""Eight animated files, made by others, in motion: assets/moving/README.md.  Runs inside Blender.

    blender -b --factory-startup --python tests/images/moving_files.py -- SCENE VARIANT ENGINE OUT.exr SAMPLES

VARIANT: `emission` (each material a colour that glows: nothing but motion and coverage), `lit` (the file's own
materials and lights, no bounces) or `still` (emission without motion blur, which says where blur changes pixels).
"""

import colorsys
import sys
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
DEMO = HERE.parent.parent / "demo"
sys.path[:0] = [str(HERE), str(DEMO)]
import engines  # noqa: E402
import keyframes  # noqa: E402

ASSETS = HERE / "assets" / "moving"
DEMO_ASSETS = DEMO / "assets"
WIDTH, HEIGHT = 240, 135
if "bool" not in vars(np):
    np.bool = bool  # the glTF importer of Blender 3.4 asks for it


def open_file(name, frame, shutter):
    bpy.ops.wm.open_mainfile(filepath=str(ASSETS / f"{name}.blend"))
    bpy.context.scene.frame_set(frame)
    return shutter


def import_file(path, frame, shutter, clip):
    """One clip of a glTF file; its others muted."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    keys = [item.data.shape_keys for item in bpy.data.objects if item.type == "MESH"]
    for thing in [*bpy.data.objects, *(key for key in keys if key)]:
        data = thing.animation_data
        for track in data.nla_tracks if data else ():
            track.mute = not track.name.startswith(clip)
    bpy.context.scene.frame_set(frame)
    return shutter


def move(item, path, value, index):
    """Linear: `value` more a frame, from the current frame on."""
    frame = bpy.context.scene.frame_current
    start = getattr(item, path)[index]
    for offset in (-1, 4):
        getattr(item, path)[index] = start + value * offset
        item.keyframe_insert(path, index=index, frame=frame + offset)
    keyframes.make_linear(item)
    bpy.context.scene.frame_set(frame)


def bend():
    """A cylinder in a Simple Deform that swings."""
    return open_file("bend", 3, 1.0)


def camera():
    """A camera that flies past a cube."""
    return open_file("camera", 1, 0.5)


def snake():
    """A skinned snake in six materials."""
    return open_file("snake", 21, 4.0)


def instances():
    """Geometry nodes scatter cubes over a surface that moves."""
    return open_file("instances", 5, 1.0)


def particles():
    """Blades of grass, instances of a particle system, on a floor that turns."""
    shutter = open_file("particles", 1, 2.0)
    bpy.context.scene.world = bpy.data.worlds.new("Grey")  # in place of a sky that is not rendered
    for system in bpy.data.objects["Plane"].particle_systems:
        system.settings.rendered_child_count = 10
    move(bpy.data.objects["Plane"], "rotation_euler", 0.07, 2)
    return shutter


def hair():
    """20,000 hairs on a head that turns."""
    shutter = open_file("hair", 1, 2.0)
    head = bpy.data.objects["Sphere"]
    # The file's own is a play of colours by a hair's random number.
    nodes = bpy.data.materials["hair"].node_tree
    nodes.nodes.clear()
    shader = nodes.nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (0.5, 0.3, 0.15, 1)
    nodes.links.new(
        shader.outputs[0], nodes.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]
    )
    for system in head.particle_systems:
        system.settings.rendered_child_count = 4
    move(head, "rotation_euler", 0.1, 2)
    return shutter


def morph():
    """Shape keys that follow each other in a wave."""
    shutter = import_file(ASSETS / "morph.glb", 20, 2.0, "TheWave")
    engines.add_camera(bpy.context.scene, (0, -6, 2.5), (0, 0, 0.8))
    return shutter


def alien():
    """A skinned creature of many limbs."""
    shutter = import_file(DEMO_ASSETS / "Alien_Scolitex.gltf", 10, 3.0, "")
    engines.add_camera(bpy.context.scene, (3, -7, 3), (0, 0, 1.2))
    for material in bpy.data.materials:
        if material.use_nodes:
            engines.normalize_normals(material.node_tree)
    return shutter


SCENES = {s.__name__: s for s in (bend, camera, snake, instances, particles, hair, morph, alien)}


def glow():
    """Each material a colour of its own that glows; nothing else gives light."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("Black")
    scene.world.color = (0, 0, 0)
    plain = bpy.data.materials.new("Plain")
    for item in bpy.data.objects:
        if item.type == "MESH" and not item.data.materials:
            item.data.materials.append(plain)
    for index, material in enumerate(sorted(bpy.data.materials, key=lambda m: m.name)):
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        emission = tree.nodes.new("ShaderNodeEmission")
        color = colorsys.hsv_to_rgb(index * 0.382 % 1, 0.6, 0.9)
        emission.inputs["Color"].default_value = (*color, 1)
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(emission.outputs[0], output.inputs["Surface"])


def light():
    """A sun where the file has no light."""
    scene = bpy.context.scene
    if scene.world is None:
        scene.world = bpy.data.worlds.new("World")
        scene.world.color = (0.05, 0.05, 0.05)
    if not any(item.type == "LIGHT" for item in scene.objects):
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        sun.data.energy, sun.data.angle = 3.0, 0.1
        sun.rotation_euler = (0.6, 0.3, 0.2)
        scene.collection.objects.link(sun)


def build(name, variant):
    """Opens a scene as `variant`; returns (scene, frame at which the shutter opens, frames that it stays open)."""
    shutter = SCENES[name]()
    light() if variant == "lit" else glow()
    scene = bpy.context.scene
    scene.cycles_curves.shape = "RIBBONS"
    engines.set_size(scene, WIDTH, HEIGHT)
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    return scene, scene.frame_current, 0 if variant == "still" else shutter


def main():
    name, variant, engine, out, samples = sys.argv[sys.argv.index("--") + 1 :]
    scene, opens, shutter = build(name, variant)
    if engine == "CYCLES":
        engines.set_cycles(scene, int(samples))
    else:
        # With 256 samples 32 light samples.
        engines.set_granita(scene, int(samples), light_samples=8, dicing_rate=0.5)
    engines.set_motion(scene, engine, opens, shutter)
    print(f"seconds {engines.render(scene, out):.3f}")


if __name__ == "__main__":
    main()
