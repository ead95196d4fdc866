# SPDX-License-Identifier: GPL-3.0-or-later
"""10, 100 and 1000 lamps of the same power together: seconds and error, beside Cycles with its light tree.

    ./dev bench many_lamps [--counts 10 1000] [--reference 256]

320 x 180, one thread each, in turns, in Blender as a Python module; no bounces.  Errors are relative to the mean of the
picture, against the mean of two of Cycles' pictures of half the reference's samples; the reference's own is printed and not
deducted.  Seconds are those of the processor, medians of three.  Prints a table, writes bench/results/many_lamps.json.
"""

import argparse

import frames
import numpy as np
from measure import save

VERSION = "4.5"
PYTHON = str(frames.CACHE.parent / f"bpy-{VERSION}" / "bin" / "python")
SETTINGS = {
    "Granita, 4 samples, 4 light samples": {"engine": "GRANITA", "samples": 4, "light_samples": 4},
    "Granita, 16": {"engine": "GRANITA", "samples": 16},
    "Granita, 64": {"engine": "GRANITA", "samples": 64},
    "Cycles, 16": {"engine": "CYCLES", "samples": 16},
    "Cycles, 64": {"engine": "CYCLES", "samples": 64},
}


def reference(scene, samples):
    files = ("lamp_scenes.py", "lit_scenes.py", "scenes.py")
    job = {"module": "lamp_scenes", "scene": scene, "runs": 1, "settings": [{"engine": "CYCLES"}]}
    return frames.reference_of_halves(f"{scene}-{VERSION}", job, samples, files, PYTHON)


def measure(count, options):
    scene = f"lamps_{count}"
    truth, own = reference(scene, options.reference)
    job = {"module": "lamp_scenes", "scene": scene, "runs": 3}
    job["settings"] = list(SETTINGS.values())
    rows = []
    for kind, (image, seconds) in zip(SETTINGS, frames.render(job, python=PYTHON), strict=True):
        mean = truth.mean()
        error = frames.errors(image, truth)
        row = {
            "lamps": count,
            "kind": kind,
            "seconds": seconds,
            "relative_rmse": error["rmse"] / mean,
            "relative_median": float(np.median(np.abs(image - truth).mean(-1)) / mean),
            "flip": error["flip"],
            "bias": float((image - truth).mean() / mean),
            "reference_error": own / mean,
        }
        rows.append(row)
        print(
            f"| {count} | {kind} | {seconds:.2f} | {row['relative_rmse']:.4f} | {row['relative_median']:.4f} "
            f"| {row['flip']:.4f} | {row['bias']:+.4f} | {row['reference_error']:.4f} |",
            flush=True,
        )
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--counts", nargs="+", type=int, default=(10, 100, 1000))
    parser.add_argument("--reference", type=int, default=256)
    options = parser.parse_args()
    print(
        "| lamps | | seconds | RMSE | median error | FLIP | mean error | the reference's own RMSE |"
    )
    print("|---|---|---|---|---|---|---|---|")
    save("many_lamps", [row for count in options.counts for row in measure(count, options)])


if __name__ == "__main__":
    main()
