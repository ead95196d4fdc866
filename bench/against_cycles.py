# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole frames against Cycles in the same Blender, interleaved: seconds and error.

    ./dev blender -b --factory-startup --python bench/against_cycles.py -- [--samples 64] [--runs 3] [--out FILE.json]

Scene: 60 emissive spheres that all move by the same number of pixels; no bounces, Blackman-Harris 1.5.
Error: RMSE against Cycles at 4096 samples, over the pixels that are not the same in all frames of the table.
One thread each, so that seconds are seconds of a core.  Prints a table and, with --out, writes JSON.
"""

import argparse
import json
import statistics
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "blender"))
import exr  # noqa: E402

WIDTH, HEIGHT, SCALE = 480, 270, 16.0  # orthographic, metres across the frame's width


def build(pixels):
    """Spheres on a grid of places with seeded offsets; `pixels` of motion over the shutter."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    random = np.random.default_rng(5)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1)
    ball = bpy.context.object
    for polygon in ball.data.polygons:
        polygon.use_smooth = True
    colors = []
    for i in range(6):
        material = bpy.data.materials.new(f"Glow {i}")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        emission, output = (
            tree.nodes.new("ShaderNodeEmission"),
            tree.nodes.new("ShaderNodeOutputMaterial"),
        )
        emission.inputs["Color"].default_value = (*random.uniform(0.05, 1, 3), 1)
        tree.links.new(emission.outputs[0], output.inputs["Surface"])
        colors.append(material)
    parent = bpy.data.objects.new("Mover", None)
    scene.collection.objects.link(parent)
    for i in range(60):
        mesh = ball.data.copy()
        mesh.materials.clear()
        mesh.materials.append(colors[i % 6])
        item = bpy.data.objects.new(f"Ball {i}", mesh)
        item.location = (*random.uniform((-7, -4), (7, 4)), random.uniform(-5, 5))
        item.scale = (random.uniform(0.3, 1.1),) * 3
        item.parent = parent
        scene.collection.objects.link(item)
    bpy.data.objects.remove(ball)
    if pixels:
        step = pixels * SCALE / WIDTH
        for frame, x in ((0, -2 * step), (2, 2 * step)):  # the shutter of half a frame sees `step`
            parent.location.x = x
            parent.keyframe_insert("location", frame=frame)
        for curve in parent.animation_data.action.fcurves:
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"
    data = bpy.data.cameras.new("Camera")
    data.type, data.ortho_scale = "ORTHO", SCALE
    camera = bpy.data.objects.new("Camera", data)
    camera.location.z = 20
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = bool(pixels), 0.5
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "NONE"
    scene.frame_set(1)
    return scene


def render(scene, engine, samples, folder):
    scene.render.engine = engine
    if engine == "CYCLES":
        cycles = scene.cycles
        cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = samples, False, False
        cycles.max_bounces, cycles.pixel_filter_type, cycles.filter_width = (
            0,
            "BLACKMAN_HARRIS",
            1.5,
        )
    else:
        scene.granita.samples = samples
    scene.render.filepath = str(Path(folder) / "frame.exr")
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - start
    channels = exr.read(scene.render.filepath)
    pick = lambda letter: next(v for k, v in channels.items() if k.split(".")[-1] == letter)  # noqa: E731
    return seconds, np.stack([pick(c) for c in "RGB"], -1)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--out")
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for pixels in (0, 5, 20, 100):
            scene = build(pixels)
            _, reference = render(scene, "CYCLES", 4096, folder)
            seconds = {"GRANITA": [], "CYCLES": []}
            error = {}
            for _ in range(options.runs):
                for engine in seconds:
                    time_taken, image = render(scene, engine, options.samples, folder)
                    seconds[engine].append(time_taken)
                    error[engine] = float(np.sqrt(np.mean((image - reference) ** 2)))
            row = {"pixels": pixels, "samples": options.samples}
            for engine, times in seconds.items():
                row[engine.lower()] = {"seconds": statistics.median(times), "rmse": error[engine]}
            row["ratio"] = row["cycles"]["seconds"] / row["granita"]["seconds"]
            rows.append(row)
            print(
                f"{pixels:4d} px  Granita {row['granita']['seconds']:7.2f} s rmse {row['granita']['rmse']:.5f}   "
                f"Cycles {row['cycles']['seconds']:7.2f} s rmse {row['cycles']['rmse']:.5f}   "
                f"Cycles takes {row['ratio']:.2f} times as long"
            )
    if options.out:
        Path(options.out).write_text(json.dumps(rows, indent=1) + "\n")


main()
