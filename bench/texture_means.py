# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a texture's mean light is left as it shrinks: Granita beside Cycles, a curve.  Runs inside Blender.

    blender -b --factory-startup --addons granita --python bench/texture_means.py -- MEASURED.json [FIGURE.svg]

A plane of 64 x 64 pixels shows an image of 1024 x 1024 texels, black and white at random in blocks of 1 or of 4 texels a
side, repeated or cut so that a pixel covers so many texels.  Drawn is the mean of the picture over that of the texels.
Both renderers take 64 samples.  An existing file of measures keeps what it has of other builds: `name=NAME` before it
names the curve, Granita where it is left out.
"""

import json
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests" / "images")]
import plot  # noqa: E402

TEXELS = (0.25, 0.5, 0.7, 1, 1.4, 2, 4, 8, 16)
SIDE, PIXELS = 1024, 64


def blocks(size):
    random = np.random.default_rng(5)
    n = SIDE // size
    return np.kron(random.integers(0, 2, (n, n)), np.ones((size, size))).astype(np.float32)


def make_scene(values):
    """(scene, the node whose scale is the texels' a pixel)"""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.preferences.addon_enable(module="granita")
    image = bpy.data.images.new("Blocks", SIDE, SIDE)
    pixels = np.ones((SIDE, SIDE, 4), dtype=np.float32)
    pixels[..., :3] = values[..., None]
    image.pixels.foreach_set(pixels.ravel())
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
    mesh.uv_layers.new().data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    scene.collection.objects.link(bpy.data.objects.new("Plane", mesh))
    material = bpy.data.materials.new("Material")
    material.use_nodes = True
    mesh.materials.append(material)
    tree = material.node_tree
    tree.nodes.clear()
    new, link = tree.nodes.new, tree.links.new
    output, emission = new("ShaderNodeOutputMaterial"), new("ShaderNodeEmission")
    texture, scale, uv = (
        new("ShaderNodeTexImage"),
        new("ShaderNodeVectorMath"),
        new("ShaderNodeTexCoord"),
    )
    texture.image, scale.operation = image, "SCALE"
    link(uv.outputs["UV"], scale.inputs[0])
    link(scale.outputs[0], texture.inputs[0])
    link(texture.outputs["Color"], emission.inputs["Color"])
    link(emission.outputs[0], output.inputs["Surface"])
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 2
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location.z = 2
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.cycles.samples = scene.granita.samples = 64
    scene.granita.bounces = "NONE"
    scene.cycles.use_denoising = False
    return scene, scale


def mean(scene, engine, folder):
    scene.render.engine = engine
    scene.render.filepath = str(Path(folder) / "picture.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(PIXELS * PIXELS * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return float(pixels.reshape(-1, 4)[:, 0].mean())


def measure(ours):
    curves = {}
    with tempfile.TemporaryDirectory() as folder:
        for size in (1, 4):
            values = blocks(size)
            scene, scale = make_scene(values)
            for texels in TEXELS:
                part = PIXELS * texels / SIDE
                scale.inputs["Scale"].default_value = part
                # Where less than the whole is seen, its own mean is the truth.
                seen = values[: round(SIDE * min(part, 1)), : round(SIDE * min(part, 1))]
                for engine, name in (("GRANITA", ours), ("CYCLES", "Cycles")):
                    value = mean(scene, engine, folder) / float(seen.mean())
                    curves.setdefault(f"blocks of {size}", {}).setdefault(name, []).append(
                        (texels, value)
                    )
    return curves


def main():
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    ours = "Granita"
    if arguments[0].startswith("name="):
        ours = arguments.pop(0).removeprefix("name=")
    file = Path(arguments[0])
    measured = json.loads(file.read_text()) if file.exists() else {}
    for title, curves in measure(ours).items():
        measured.setdefault(title, {}).update(curves)
    file.write_text(json.dumps(measured, indent=1) + "\n")
    if len(arguments) > 1:
        panels = [plot.Panel(title, curves, levels=(1.0,)) for title, curves in measured.items()]
        plot.save(Path(arguments[1]), panels, "texels a pixel", "mean light, of the texels'", 2)


main()
