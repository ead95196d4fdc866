# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a frame that is all one bucket, and one that is all one instance, keep several threads busy.

    ./dev bench nested_parallelism [--threads 2] [--runs 5]

On a busy machine the wall clock says little: what is compared is the processor time of the thread that works longest, which
is what the frame takes on an idle machine with a core a thread.  Frames of 1 and of N threads alternate; each is a process
of its own.  Prints a Markdown table and writes bench/results/nested_parallelism.json.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import threading
import time

import measure
import numpy as np
from snapshot_scenes import s

SAMPLER_PERIOD = 0.002  # s


def diffuse(snapshot):
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.6, 0.4, 1)}}]
    snapshot["materials"].append({"name": "Diffuse", "nodes": nodes, "surface": (0, "BSDF")})
    return len(snapshot["materials"]) - 1


def hairy_bucket(threads, hairs=6000):
    """Hair under a sun in 62x62 pixels, which with their filter margin are one bucket."""
    snapshot = s.orthographic(
        (64, 64),
        samples=16,
        threads=threads,
        pixel_filter="BLACKMAN_HARRIS",
        filter_width=1.5,
        crop=(1, 1, 63, 63),
    )
    random, along = np.random.default_rng(3), np.linspace(0, 1, 9)
    root = random.uniform((0, 0, 100), (64, 64, 140), (hairs, 3))
    lean = random.normal(0, 8, (hairs, 3))
    points = root[:, None] + lean[:, None] * along[:, None]
    points += np.array([0, 6, 0]) * along[:, None] ** 2
    snapshot["geometries"].append(
        {
            "name": "curves 'Hair'",
            "kind": "CURVES",
            "points": points.astype(np.float32).reshape(1, -1, 3),
            "curve_sizes": np.full(hairs, len(along), np.int32),
            "radius": np.tile(0.25 * (1 - 0.8 * along), hairs).astype(np.float32)[None],
        }
    )
    s.instance(snapshot, 0, diffuse(snapshot))
    sun = {"name": "Sun", "kind": "SUN", "color": (1, 1, 1), "energy": 3.0, "sun_angle": 0.1}
    down = np.diag([1.0, -1.0, -1.0, 1.0])[None]
    snapshot["lights"] = [{**sun, "world_from_light": down}]
    return snapshot


def hero(threads, faces=1_000_000):
    """A bumpy ball of small faces that fills a frame of 480x270 pixels and shines by itself."""
    snapshot = s.perspective(
        (480, 270),
        450.0,
        samples=4,
        threads=threads,
        pixel_filter="BLACKMAN_HARRIS",
        filter_width=1.5,
    )
    side = round(faces**0.5)
    theta, phi = np.meshgrid(
        np.linspace(0.02, np.pi - 0.02, side + 1),
        np.linspace(0, 2 * np.pi, side, endpoint=False),
        indexing="ij",
    )
    radius = 1 + 0.05 * np.sin(8 * theta) * np.cos(9 * phi)
    ring = radius * np.sin(theta)
    points = np.stack([ring * np.cos(phi), radius * np.cos(theta), 4 + ring * np.sin(phi)], -1)
    i, j = np.divmod(np.arange(side * side), side)
    k = (j + 1) % side
    corners = np.stack([i * side + j, (i + 1) * side + j, (i + 1) * side + k, i * side + k], -1)
    snapshot["geometries"].append(
        {
            "name": "mesh 'Hero'",
            "points": points.reshape(1, -1, 3).astype(np.float32),
            "face_sizes": np.full(side * side, 4, np.int32),
            "corner_verts": corners.reshape(-1).astype(np.int32),
            "smooth": np.ones(side * side, np.uint8),
        }
    )
    s.instance(snapshot, 0, s.emission(snapshot, (1, 0.5, 0.2)))
    return snapshot


SCENES = {"hairy_bucket": hairy_bucket, "hero": hero}


class ThreadClock(threading.Thread):
    """Processor seconds of the process's other threads, read while they live."""

    def __init__(self):
        super().__init__(daemon=True)
        self.seconds, self.over = {}, threading.Event()

    def run(self):
        own = threading.get_native_id()
        while not self.over.wait(SAMPLER_PERIOD):
            for task in os.listdir("/proc/self/task"):
                try:
                    taken = pathlib.Path(f"/proc/self/task/{task}/schedstat").read_text()
                except (FileNotFoundError, ProcessLookupError):
                    continue
                if int(task) != own:
                    self.seconds[task] = int(taken.split()[0]) * 1e-9


def one_frame(name, threads):
    """What a process of its own prints: the busiest thread's seconds, and the frame's."""
    snapshot = SCENES[name](threads)
    clock = ThreadClock()
    main = str(threading.get_native_id())
    clock.start()
    time.sleep(5 * SAMPLER_PERIOD)
    before = clock.seconds.get(main, 0.0)
    taken = s.render(snapshot)["statistics"]
    clock.over.set()
    clock.join()
    clock.seconds[main] -= before
    stages = {k: round(v, 3) for k, v in taken.items() if k.startswith("seconds_") and v > 0.001}
    print(json.dumps({"busiest": max(clock.seconds.values()), **stages}))


def ask(name, threads):
    command = [sys.executable, __file__, "--frame", name, "--threads", str(threads)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--frame", choices=SCENES)
    options = parser.parse_args()
    if options.frame:
        return one_frame(options.frame, options.threads)
    table = measure.Table()
    table.header()
    for name in SCENES:
        taken = {1: [], options.threads: []}
        for _ in range(options.runs):
            for threads in taken:
                taken[threads].append(ask(name, threads)["busiest"])
        one, many = (statistics.median(taken[n]) for n in taken)
        what = f"{name}: busiest thread of 1 ({one:.2f} s) over that of {options.threads}"
        table.row(what, one / many, 0.75 * options.threads, least=True)
    table.save("nested_parallelism")


if __name__ == "__main__":
    main()
