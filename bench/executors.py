# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds and error of each executor on the machine that runs this: the CPU's, and the GPU's through OpenGL.

    PYTHONPATH=<folder of granita_core> python3 bench/executors.py [--machine NAME] [--scenes spheres ...]

Wall clock of whole frames, medians of three taken in turns (fewer of what takes seconds); error is the RMSE beside 1,024
samples of the CPU's executor with another seed.  Passes are the chapter's sampling: a rotated lattice for the whole
picture, at times and lens points that all pixels share.  "GPU" is what OpenGL offers, which the results name.  Writes
bench/results/executors_NAME.json.
"""

import argparse
import os
import statistics
import time

import figure_scenes
import measure
import snapshot_scenes
from figures import rmse

import granita_core

THREADS = len(os.sched_getaffinity(0))
LONG = 4.0  # seconds
REFERENCE = {"executor": "SIMD", "samples": 1024, "seed": 9}


def samples(executor, count, **options):
    return {"executor": executor, "samples": count, **options}


def passes(executor, lattice, times, **options):
    """`times` passes of about `lattice` samples a pixel."""
    regular = {"sampling": "REGULAR", "time_samples": times}
    return samples(executor, lattice, **regular, **options)


SETTINGS = {
    "CPU, 16 samples": samples("SIMD", 16),
    "CPU, 64 samples": samples("SIMD", 64),
    "CPU, 256 samples": samples("SIMD", 256),
    "GPU compute, 64 samples": samples("COMPUTE", 64),
    "CPU, 16 passes of 17": passes("SIMD", 16, 16),
    "GPU raster, 16 passes of 17": passes("RASTER", 16, 16),
    "GPU raster, 16 passes of 65": passes("RASTER", 64, 16),
    "CPU, 64 samples, 4 threads": samples("SIMD", 64, threads=4),
    "GPU raster, 16 passes of 17, 4 threads": passes("RASTER", 16, 16, threads=4),
}


def defocused(snapshot):
    """Seen by a camera with a lens, whose circles of confusion have radii of up to 6 pixels."""
    snapshot["camera"] |= {"lens_radius": 4.0, "focus_distance": 200.0}
    return snapshot


SCENES = {
    "spheres": lambda: snapshot_scenes.enlarged(snapshot_scenes.spheres(pixels=20 / 3), 3),
    "lens": lambda: snapshot_scenes.enlarged(defocused(snapshot_scenes.spheres(pixels=20 / 3)), 3),
    "particles": lambda: snapshot_scenes.enlarged(figure_scenes.particles(2000, {}), 2),
}


def rendered(snapshot, options):
    """(result, seconds of the clock)."""
    options = {**snapshot["options"], "threads": THREADS, **options}
    return measure.render({**snapshot, "options": options}, time.perf_counter)


def measured(name, build, runs):
    snapshot = build()
    reference = rendered(snapshot, REFERENCE)[0]["combined"]
    seconds = {setting: [] for setting in SETTINGS}
    results = {}
    for _ in range(runs):
        for setting, options in SETTINGS.items():
            if sum(seconds[setting]) > LONG:
                continue
            results[setting], taken = rendered(snapshot, options)
            seconds[setting].append(taken)
    rows = []
    for setting, result in results.items():
        row = {
            "scene": name,
            "setting": setting,
            "device": result["statistics"]["device"],
            "seconds": round(statistics.median(seconds[setting]), 3),
            "rmse": rmse(result["combined"], reference),
        }
        rows.append(row)
        print("| {scene} | {setting} | {seconds:.3f} | {rmse:.5f} |".format(**row), flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--machine", default="here", help="in the name of the results' file")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    print(f"| scene | setting, {THREADS} threads | seconds | RMSE |\n|---|---|---|---|", flush=True)
    rows = []
    for name in arguments.scenes:
        rows += measured(name, SCENES[name], arguments.runs)
        machine = {"threads": THREADS, "opengl": granita_core.opengl()}
        measure.save(f"executors_{arguments.machine}", {**machine, "rows": rows})


if __name__ == "__main__":
    main()
