# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds from an edit to its first picture and to the settled one, in a view without a window, so that drawing costs
nothing.  Runs inside Blender, for viewport_drags.py.

    blender -b --factory-startup --addons granita --python bench/time_viewport.py -- JOB.json

JOB: {"scenes", "edits", "runs", "file"}.  The file gets [{"scene", "edit", "first", "processor", "settled"}]: medians.
"""

import json
import statistics
import sys
import time
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests" / "blender")]
import lit_scenes  # noqa: E402
import scenes  # noqa: E402
import view_edits  # noqa: E402
from view_parts import View  # noqa: E402

SIZE = 480, 270


def build(name):
    scene = {**scenes.SCENES, **lit_scenes.SCENES}[name]()
    render = scene.render
    render.engine, render.threads_mode = "GRANITA", "AUTO"
    render.resolution_x, render.resolution_y = SIZE
    render.use_motion_blur = True
    scene.granita.preview_samples, scene.granita.bounces = 64, "NONE"
    view_edits.open_lens(scene.camera.data)
    return scene


def first_picture(view):
    """Goes on until a picture is shown that was not there before."""
    before = view.live.counts["pictures"]
    while view.live.counts["pictures"] == before:
        view.step()
        time.sleep(0.0005)


def main():
    job = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    rows = []
    for name in job["scenes"]:
        scene = build(name)
        view = View(SIZE).look_through_camera()
        view.edited().settle()
        for edit in job["edits"]:
            if edit.startswith("lamp") and not any(t.type == "LIGHT" for t in bpy.data.objects):
                continue
            taken = []
            for k in range(job["runs"] + 1):
                view_edits.EDITS[edit](scene, None, k)
                began = time.perf_counter(), time.process_time()
                view.edited()
                first_picture(view)
                taken.append((time.perf_counter() - began[0], time.process_time() - began[1]))
            view.settle()
            row = {"scene": name, "edit": edit, "settled": time.perf_counter() - began[0]}
            # Of the first edit the picture before has other pixels.
            wall, processor = zip(*taken[1:], strict=True)
            row |= {"first": statistics.median(wall), "processor": statistics.median(processor)}
            rows.append(row | {"divisor": view.live.costs.divisor})
        view.close()
    Path(job["file"]).write_text(json.dumps(rows))


main()
