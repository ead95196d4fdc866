# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves a file that wants memory, float output: for test_memory_limit.py.

blender -b --factory-startup --addons granita --python memory_scenes.py -- FILE textures|MILLIONS_OF_FACES
"""

import math
import shutil
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blender"))
import scene_parts  # noqa: E402

TEXTURES, TEXTURE_SIDE = 12, 4096
FACES_A_PART, PARTS_A_ROW = 10_000, 25


def textures(scene, folder):
    """Squares that glow, each by an image of its own of 4096 x 4096."""
    scene.render.resolution_x, scene.render.resolution_y = 1200, 400
    scene_parts.add_camera(scene, ortho_scale=6.0)
    first = bpy.data.images.new("First", TEXTURE_SIDE, TEXTURE_SIDE)
    first.generated_type, first.file_format = "COLOR_GRID", "PNG"
    first.filepath_raw = str(folder / "0.png")
    first.save()
    for n in range(TEXTURES):
        path = folder / f"{n}.png"
        if n > 0:
            shutil.copy(folder / "0.png", path)
        glow = scene_parts.emission(f"Glow{n}", (1.0, 1.0, 1.0))
        nodes, links = glow.node_tree.nodes, glow.node_tree.links
        image = nodes.new("ShaderNodeTexImage")
        image.image = bpy.data.images.load(str(path))
        shader = next(node for node in nodes if node.type == "EMISSION")
        links.new(image.outputs["Color"], shader.inputs["Color"])
        place = (n % 6 - 2.5, n // 6 - 0.5, 0.0)
        scene_parts.add_square(scene, f"Square{n}", 0.95, place, glow).data.uv_layers.new()


def faces(scene, millions):
    """As many that modifiers make of ten thousand, under a sun, all of them seen."""
    scene.render.resolution_x, scene.render.resolution_y = 320, 240
    side = math.isqrt(FACES_A_PART)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side, size=1.0)
    hills = bpy.context.object
    hills.name = hills.data.name = "Hills"
    hills.rotation_euler.y = 0.4
    across = hills.modifiers.new("Across", "ARRAY")
    across.count = PARTS_A_ROW
    along = hills.modifiers.new("Along", "ARRAY")
    along.count = millions * 1_000_000 // (FACES_A_PART * PARTS_A_ROW)
    along.relative_offset_displace = (0.0, 1.0, 0.0)
    for modifier in (across, along):
        modifier.show_viewport = False
    scene_parts.add_camera(scene, (12.0, 10.0, 30.0), ortho_scale=30.0)
    sun = bpy.data.lights.new("Sun", "SUN")
    scene_parts.add_object(scene, "Sun", sun).rotation_euler.x = 0.7


def save(file, kind):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "GRANITA"
    scene.granita.samples, scene.granita.bounces = 4, "NONE"
    scene_parts.multilayer_exr(scene)
    if kind == "textures":
        textures(scene, Path(file).parent)
    else:
        faces(scene, int(kind))
    bpy.ops.wm.save_as_mainfile(filepath=file)


save(*sys.argv[sys.argv.index("--") + 1 :])
