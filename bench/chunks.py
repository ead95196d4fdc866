# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames as jobs of their own beside one job of all of them: what a farm's chunk shares.

    ./dev bench chunks [--runs 3] [--frames 8] [--samples 4] [--size 96 54]

The demo and an animated file by others (tests/images/moving_files.py, as it is lit); processor seconds of whole Blenders,
one thread, in turns, medians.  A job's frame costs more than a further one of a chunk by what a Blender begins with: its start, the
opening of the file, and what the first frame makes for all.  Prints a Markdown table, writes bench/results/chunks.json.
"""

import argparse
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

import frames
from measure import save

SCENES = {
    "demo": {"module": "demo", "scene": "demo"},
    "snake": {"module": "moving_files", "scene": "snake", "variant": "lit"},
}
BLENDER = ["blender", "-b", "--factory-startup", "--addons", "granita", "--python-exit-code", "1"]


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def seconds_of(*arguments):
    """Processor seconds of a Blender."""
    began = processor_seconds()
    done = subprocess.run([*BLENDER, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stdout[-3000:] + done.stderr[-3000:])
    return processor_seconds() - began


class Shot:
    """A file of an animation, and the jobs that render it."""

    def __init__(self, name, folder, options):
        self.file, self.out = folder / f"{name}.blend", folder / name / "####"
        self.frames = options.frames
        job = {**SCENES[name], "blend": str(self.file), "size": options.size}
        frames.ask("render_frames.py", {**job, "runs": 0, "settings": []})
        width, height = options.size
        self.stage = [
            "--python-expr",
            f"import bpy; s = bpy.context.scene; s.granita.samples, s.granita.bounces = {options.samples}, 'NONE'; "
            f"s.render.resolution_x, s.render.resolution_y = {width}, {height}; "
            "s.render.resolution_percentage = 100",
        ]

    def render(self, *which):
        words = ["-E", "GRANITA", "-o", self.out, "-F", "PNG", *which]
        return seconds_of(self.file, *self.stage, *words, "--", "--granita-threads", "1")

    def measured(self):
        jobs = sum(self.render("-f", frame) for frame in range(1, self.frames + 1))
        chunk = self.render("-s", 1, "-e", self.frames, "-a")
        start = seconds_of()
        return {"jobs": jobs, "chunk": chunk, "start": start, "opened": seconds_of(self.file)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--size", type=int, nargs=2, default=(96, 54))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        shots = {name: Shot(name, Path(folder), options) for name in SCENES}
        taken = {name: [] for name in SCENES}
        for _ in range(options.runs):
            for name, shot in shots.items():
                taken[name].append(shot.measured())
    rows = []
    print(
        f"| file | {options.frames} jobs, s | one chunk, s | a job | a further frame of a chunk ",
        end="",
    )
    print("| start of Blender | opening of the file |\n" + "|---" * 7 + "|")
    for name, runs in taken.items():
        row = {key: statistics.median(found[key] for found in runs) for key in runs[0]}
        row["job"] = row["jobs"] / options.frames
        row["further"] = (row["chunk"] - row["job"]) / (options.frames - 1)
        row["opening"] = row["opened"] - row["start"]
        rows.append({"file": name, **row})
        keys = ("jobs", "chunk", "job", "further", "start", "opening")
        print(f"| {name} | " + " | ".join(f"{row[key]:.2f}" for key in keys) + " |")
    save("chunks", rows)


if __name__ == "__main__":
    main()
