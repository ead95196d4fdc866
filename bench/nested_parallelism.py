# SPDX-License-Identifier: GPL-3.0-or-later
"""How far frames keep several threads busy: one that is all one bucket, one that is all one instance, and two of many.

    ./dev bench nested_parallelism [--threads 2 ...] [--runs 5] [--machine NAME]

On a busy machine the wall clock says little: what is compared is the processor time of the thread that works longest, which
is what the frame takes on an idle machine with a core a thread; the wall clock is printed beside it.  Frames of 1 and of
N threads alternate; each is a process of its own.  Prints a Markdown table and writes
bench/results/nested_parallelism[_NAME].json.
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
import snapshot_scenes
from snapshot_scenes import s

SAMPLER_PERIOD = 0.002  # s


def diffuse(snapshot, color=(0.8, 0.6, 0.4, 1)):
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": color}}]
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


def moving_spheres(threads):
    """60 spheres that shine by themselves and move by 20 of 1920 x 1080 pixels."""
    snapshot = snapshot_scenes.spheres(20 / 6, threads=threads, samples=64)
    return snapshot_scenes.enlarged(snapshot, 6)


def room(threads):
    """40 balls in a closed room with a lamp, lit by four bounces; 320 x 180 pixels."""
    snapshot = s.perspective(
        (320, 180), 200, threads=threads, samples=16, light_samples=16, bounces=4
    )
    corners = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    walls = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    s.mesh(snapshot, np.array(corners) * (4.0, 2.0, 6.0), walls, diffuse(snapshot, (0.7,) * 4))
    random = np.random.default_rng(4)
    points, faces = snapshot_scenes.unit_sphere()
    for _ in range(40):
        place = random.uniform((-3, -1.5, 1), (3, 1.5, 5.5))
        ball = points * random.uniform(0.1, 0.4) + place
        s.mesh(snapshot, ball, faces, diffuse(snapshot, (*random.uniform(0.2, 0.9, 3), 1)))
    lamp = {"name": "Lamp", "kind": "POINT", "color": (1, 1, 1), "energy": 200.0, "radius": 0.2}
    snapshot["lights"] = [{**lamp, "world_from_light": s.translation(0.0, 1.2, 3.0)[None]}]
    return snapshot


SCENES = {
    "hairy_bucket": hairy_bucket,
    "hero": hero,
    "moving_spheres": moving_spheres,
    "room": room,
}


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
    """What a process of its own prints: the busiest thread's seconds, and the frame's by the clock."""
    snapshot = SCENES[name](threads)
    clock = ThreadClock()
    main = str(threading.get_native_id())
    clock.start()
    time.sleep(5 * SAMPLER_PERIOD)
    before = clock.seconds.get(main, 0.0)
    wall = measure.render(snapshot, time.perf_counter)[1]
    clock.over.set()
    clock.join()
    clock.seconds[main] -= before
    print(json.dumps({"busiest": max(clock.seconds.values()), "wall": wall}))


def ask(name, threads):
    command = [sys.executable, __file__, "--frame", name, "--threads", str(threads)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def median(frames):
    return {what: statistics.median(frame[what] for frame in frames) for what in frames[0]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--threads", type=int, nargs="+", default=[2])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--machine", help="in the name of the results' file")
    parser.add_argument("--frame", choices=SCENES)
    options = parser.parse_args()
    if options.frame:
        return one_frame(options.frame, *options.threads)
    table = measure.Table()
    table.header()
    for name in SCENES:
        taken = {threads: [] for threads in [1, *options.threads]}
        for _ in range(options.runs):
            for threads in taken:
                taken[threads].append(ask(name, threads))
        one = median(taken.pop(1))
        for threads, frames in taken.items():
            many = median(frames)
            seconds = f"by the clock {one['wall']:.2f} and {many['wall']:.3f} s"
            what = f"{name}: busiest thread of 1 over that of {threads}; {seconds}"
            table.row(what, one["busiest"] / many["busiest"], 0.75 * threads, least=True)
    table.save("_".join(filter(None, ["nested_parallelism", options.machine])))


if __name__ == "__main__":
    main()
