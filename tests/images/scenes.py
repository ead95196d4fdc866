# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that Granita must render like Cycles without bounces.  Runs inside Blender.

    blender -b --factory-startup --python tests/images/scenes.py -- SCENE ENGINE OUT.exr SAMPLES [LIGHT_SAMPLES DICING_RATE]

Renders one scene at 240 x 135 to 32-bit OpenEXR and prints its seconds.  Pictures are held against the references
in references/, which make_references.py made with Cycles.
"""

import math
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

HERE = Path(__file__).resolve().parent
ASSETS = HERE / "assets"
DEMO = HERE.parent.parent / "demo"
sys.path.insert(0, str(HERE))
import engines  # noqa: E402

if "bool" not in vars(np):
    np.bool = bool  # the glTF importer of Blender 3.4 asks for it


def empty():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    return scene


def light(kind, energy, location, target=(0, 0, 0), **properties):
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy = energy
    for name, value in properties.items():
        setattr(data, name, value)
    item = bpy.data.objects.new(data.name, data)
    item.location = location
    item.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)


def principled(name, **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    bsdf = material.node_tree.nodes["Principled BSDF"]
    for socket, value in inputs.items():
        bsdf.inputs[socket.replace("_", " ")].default_value = value
    return material


def floor(z=0.0, color=(0.5, 0.5, 0.5, 1)):
    bpy.ops.mesh.primitive_plane_add(size=40, location=(0, 0, z))
    bpy.context.object.data.materials.append(principled("Floor", Base_Color=color, Roughness=0.8))


def metal():
    """A brushed gold bunny under studio.hdr."""
    scene = empty()
    tree = scene.world.node_tree
    image = tree.nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(str(DEMO / "assets" / "studio.hdr"))
    tree.links.new(image.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    bpy.ops.import_scene.gltf(filepath=str(DEMO / "assets" / "bunny.gltf"))
    gold = principled("Gold", Base_Color=(0.9, 0.6, 0.2, 1), Metallic=1.0, Roughness=0.3)
    for item in bpy.data.objects:
        if item.type == "MESH":
            item.data.materials.clear()
            item.data.materials.append(gold)
        if item.animation_data:
            item.animation_data_clear()
    engines.add_camera(bpy.context.scene, (4.2, -6.6, 3.2), (0.35, 0, 1.35))


def object_alpha():
    """Leaves cut out by an image's alpha, over each other and over a floor, under a spot."""
    bpy.ops.wm.open_mainfile(filepath=str(ASSETS / "object_alpha.blend"))
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    material = bpy.data.materials["Material.002"]
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    bsdf = tree.nodes.new("ShaderNodeBsdfPrincipled")
    image = tree.nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.load(str(ASSETS / "assets" / "leaf.png"))
    tree.links.new(image.outputs["Color"], bsdf.inputs["Base Color"])
    tree.links.new(image.outputs["Alpha"], bsdf.inputs["Alpha"])
    tree.links.new(bsdf.outputs["BSDF"], output.inputs["Surface"])


def creased():
    """A bishop whose creases are those of OpenSubdiv's own test shape."""
    empty()
    points, faces, creases = [], [], []
    for line in (ASSETS / "bishop.obj").read_text().splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            x, y, z = map(float, words[1:4])
            points.append(((x - 0.76) * 3, (y + 1.744745) * 3, z * 3))  # off its chessboard
        elif words[0] == "f":
            faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
        elif words[:2] == ["t", "crease"]:
            creases.append((int(words[3]), int(words[4]), float(words[5])))
    mesh = bpy.data.meshes.new("Bishop")
    mesh.from_pydata(points, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    sharpness = {tuple(sorted((a, b))): value for a, b, value in creases}
    # Blender's crease c is the sharpness 10 c^2 of OpenSubdiv.
    mesh.edges.foreach_set(
        "crease",
        [
            math.sqrt(min(sharpness.get(tuple(sorted(e.vertices)), 0.0) / 10, 1.0))
            for e in mesh.edges
        ],
    )
    mesh.materials.append(principled("Ivory", Base_Color=(0.8, 0.7, 0.5, 1), Roughness=0.35))
    item = bpy.data.objects.new("Bishop", mesh)
    bpy.context.scene.collection.objects.link(item)
    modifier = item.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 4
    floor(min(p[2] for p in points))
    light("AREA", 120, (3, -3, 3), size=2.0)
    light("SUN", 1.5, (-3, -2, 4), angle=0.1)
    engines.add_camera(bpy.context.scene, (3.6, -5.2, 2.2), (0, 0, 1.2), 55)


def demo():
    """The demo's direct light: its scene as `./dev demo` renders it."""
    sys.path.insert(0, str(DEMO))
    import build_scene

    build_scene.build()
    bpy.context.scene.frame_set(build_scene.FRAME)
    for material in bpy.data.materials:
        if material.use_nodes:
            engines.normalize_normals(material.node_tree)


SCENES = {"metal": metal, "object_alpha": object_alpha, "creased": creased, "demo": demo}


def render(name, engine, out, samples, light_samples, dicing_rate):
    SCENES[name]()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = (
        240,
        135,
        100,
    )
    scene.render.engine = engine
    scene.view_settings.view_transform = "Standard"
    if engine == "CYCLES":
        cycles = scene.cycles
        cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = samples, False, False
        cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = (
            cycles.transmission_bounces
        ) = 0
        cycles.transparent_max_bounces = 64
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
        cycles.blur_glossy, cycles.filter_width, cycles.pixel_filter_type = (
            0.0,
            1.5,
            "BLACKMAN_HARRIS",
        )
    else:
        scene.granita.samples, scene.granita.light_samples = samples, light_samples
        scene.granita.dicing_rate, scene.granita.bounces = dicing_rate, "NONE"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.exr_codec = "NONE"
    scene.render.use_file_extension = False
    scene.render.filepath = str(out)
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    print(f"seconds {time.perf_counter() - start:.3f}")


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1 :]
    extra = words[4:] or ["32", "0.5"]
    render(words[0], words[1], words[2], int(words[3]), int(extra[0]), float(extra[1]))
