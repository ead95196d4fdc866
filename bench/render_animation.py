# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders an animation and notes the process's memory after each frame.  Runs inside Blender, for memory_curve.py.

    blender -b --factory-startup --addons granita --python bench/render_animation.py -- JOB.json

JOB: {"file", "frames", "persistent", "bounces"}; bounces: of scene.granita.  The file gets a list of numbers, one a frame, for each of "resident" and "heap" (bytes;
"heap", exact, is empty where the allocator cannot be asked), "threads" and "files" (of the process, open ones) and "seconds".
"""

import json
import os
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "blender"))
import scene_parts  # noqa: E402
from heap import heap_bytes  # noqa: E402
from motion_parts import drive, shape_key, with_shutter  # noqa: E402


def resident_bytes():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def pictured(folder, frames):
    """A material of three images: a file, a sequence of files that changes with the frame, pixels of Blender's own."""
    material = bpy.data.materials.new("Pictured")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader, before = nodes["Principled BSDF"], None
    for name in ("Still", "Sequence0001", "Generated"):
        node, image = nodes.new("ShaderNodeTexImage"), bpy.data.images.new(name, 512, 512)
        image.generated_type = "COLOR_GRID"
        if name != "Generated":
            image.filepath_raw, image.file_format = str(folder / f"{name}.png"), "PNG"
            image.save()
            image.source = "FILE"
        if name == "Sequence0001":
            written = (folder / f"{name}.png").read_bytes()
            for number in range(2, frames + 1):
                (folder / f"Sequence{number:04}.png").write_bytes(written)
            image.source = "SEQUENCE"
            node.image_user.frame_duration, node.image_user.use_auto_refresh = frames, True
        node.image = image
        if before is None:
            before = node.outputs["Color"]
            continue
        mix = nodes.new("ShaderNodeMixRGB")
        links.new(before, mix.inputs[1])
        links.new(node.outputs["Color"], mix.inputs[2])
        before = mix.outputs[0]
    links.new(before, shader.inputs["Base Color"])
    return material


def moving_scene(folder, frames):
    """Things of each kind in motion: a turning and deforming one, instances, a subdivided one with hair and images, the
    camera."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = with_shutter(bpy.context.scene)
    scene.render.engine = "GRANITA"
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    scene.granita.samples = 16
    square = scene_parts.add_square(scene, material=scene_parts.emission("Glow", (1.0, 0.5, 0.2)))
    drive(square, "rotation_euler", "frame", 2)
    drive(shape_key(square), "value", "frame / 300")
    part = bpy.data.collections.new("Part")
    part.objects.link(square)
    place = scene_parts.add_object(scene, "Place", None)
    place.instance_type, place.instance_collection = "COLLECTION", part
    drive(place, "location", "sin(frame)", 0)
    round_one = scene_parts.add_square(scene, "Round", 3.0, (0.0, 0.0, -1.0))
    round_one.data.uv_layers.new()
    round_one.data.materials.append(pictured(folder, frames))
    round_one.modifiers.new("Subdivision", "SUBSURF").render_levels = 2
    round_one.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = round_one.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 200, 0.5
    drive(round_one, "rotation_euler", "frame / 9", 0)
    drive(scene.camera, "location", "sin(frame / 5)", 1)
    sun = scene_parts.add_object(scene, "Sun", bpy.data.lights.new("Sun", "SUN"), (0, 0, 5))
    sun.data.energy = 2.0
    return scene


def main():
    job = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    scene = moving_scene(Path(job["file"]).parent, job["frames"])
    scene.granita.bounces = job["bounces"]
    scene.render.use_persistent_data = job["persistent"]
    scene.frame_start, scene.frame_end = 1, job["frames"]
    scene.render.filepath = str(Path(job["file"]).with_name("frame_"))
    taken = {"resident": [], "heap": [], "threads": [], "files": [], "seconds": []}
    last = [time.perf_counter()]

    def note(*_):
        taken["seconds"].append(time.perf_counter() - last[0])
        taken["resident"].append(resident_bytes())
        taken["threads"].append(len(os.listdir("/proc/self/task")))
        taken["files"].append(len(os.listdir("/proc/self/fd")))
        heap = heap_bytes()
        taken["heap"] += [] if heap is None else [heap]
        last[0] = time.perf_counter()

    bpy.app.handlers.render_post.append(note)
    bpy.ops.render.render(animation=True)
    Path(job["file"]).write_text(json.dumps(taken))


main()
