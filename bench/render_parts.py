# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a frame in parts, one after the other, and joins them.  Runs inside Blender, for frame_parts.py.

    blender -b --factory-startup --addons granita --python bench/render_parts.py -- JOB.json

JOB: {"module", "scene", "size" (width, height), "samples", "bounces" (of scene.granita), "counts" [N], "folder", "file"}.  The file gets for each N
{"parts": [processor seconds of each], "merge": processor seconds, "look": processor seconds of a coarse look, "by_cost": as
"parts", cut by it}.
"""

import json
import sys
import time
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import render_frames  # noqa: E402


def seconds_of(options):
    """Processor seconds of a whole frame with these options of Granita's."""
    sys.argv[:] = [*ARGUMENTS, *options]
    began = time.process_time()
    bpy.ops.render.render(write_still=True)
    return time.process_time() - began


def seconds_of_parts(count):
    return [seconds_of([f"--granita-part={k}/{count}"]) for k in range(1, count + 1)]


def main():
    job = json.loads(Path(ARGUMENTS[ARGUMENTS.index("--") + 1]).read_text())
    scene, frame, _ = render_frames.build(job)
    render = scene.render
    render.engine = "GRANITA"
    render.resolution_x, render.resolution_y = job["size"]
    render.resolution_percentage = 100
    render.threads_mode, render.threads = "FIXED", 1
    scene.granita.samples, scene.granita.bounces = job["samples"], job["bounces"]
    scene.granita.device = "CPU"
    scene.frame_set(int(frame))
    folder = Path(job["folder"])
    render.image_settings.file_format = "OPEN_EXR"
    seconds_of([])  # what is made once in a process
    answer = {}
    for count in job["counts"]:
        render.filepath = str(folder / f"of_{count}.exr")
        answer[count] = {"parts": seconds_of_parts(count)}
        answer[count]["merge"] = seconds_of([f"--granita-merge={count}"])
        answer[count]["look"] = seconds_of([f"--granita-cut={count}"])
        answer[count]["by_cost"] = seconds_of_parts(count)
    Path(job["file"]).write_text(json.dumps(answer))


if __name__ == "__main__":
    ARGUMENTS = sys.argv[:]
    main()
