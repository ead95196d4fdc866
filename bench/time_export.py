# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds of export, of the thread that exports.  Runs inside Blender, for export_cost.py.

    blender -b --factory-startup --addons granita --python bench/time_export.py -- JOB.json

JOB: {"runs", "file"}.  The file gets {"knots": {knots: [seconds]}, "instances": [[seconds of frame 1, 2 ...]]}: of all that
Blender does to render but the rendering, and of export alone.
"""

import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "blender"))
import scene_parts  # noqa: E402
from export_probe import frame_by_frame, through_engine  # noqa: E402
from motion_parts import drive, with_shutter  # noqa: E402


def empty_scene():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return with_shutter(bpy.context.scene)


def static_crowd(count):
    """Objects of one mesh that stand, and one that turns by three radians a frame."""
    scene = empty_scene()
    mesh = scene_parts.add_square(scene, "First").data
    for i in range(count):
        scene_parts.add_object(scene, f"Still{i}", mesh, (i % 40, i // 40, 0))
    drive(scene_parts.add_square(scene, "Turning", 4.0), "rotation_euler", "3 * frame", 2)
    return scene


def crowd_of_instances(side):
    """`side` squared instances on the vertices of one mesh, and one thing that moves."""
    scene = empty_scene()
    mesh = bpy.data.meshes.new("Points")
    places = np.stack(np.meshgrid(np.arange(side), np.arange(side), [0.0]), axis=-1)
    mesh.vertices.add(side * side)
    mesh.vertices.foreach_set("co", places.astype(np.float32).ravel())
    ground = scene_parts.add_object(scene, "Ground", mesh)
    ground.instance_type = "VERTS"
    scene_parts.add_square(scene, "Leaf", 0.5).parent = ground
    drive(scene_parts.add_square(scene, "Mover"), "location", "frame", 0)
    return scene


def main():
    job = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    scene = static_crowd(1000)
    knots = {3: [], 17: []}
    for _ in range(job["runs"] + 1):  # the first, which makes Blender's own state, does not count
        for count, taken in knots.items():
            started = time.thread_time()
            through_engine(scene, motion_steps=count)
            taken.append(time.thread_time() - started)
    knots = {count: taken[1:] for count, taken in knots.items()}
    instances = []
    for _ in range(job["runs"]):
        frames = frame_by_frame(crowd_of_instances(317), range(10, 14), persistent=True)
        instances.append([frame.seconds for frame in frames])
    Path(job["file"]).write_text(json.dumps({"knots": knots, "instances": instances}))


main()
