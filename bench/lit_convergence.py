# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit pictures, seconds against error: with and without samples that are shaded by themselves, and Cycles, on the scenes of
lit_scenes.py.

    ./dev bench lit_convergence [--scenes still moving ...] [--samples 16 64] [--reference 2048]

One thread each, in turns; equal filter and shutter, no bounces.  Errors are against the mean of two of Cycles' pictures
of half the reference's samples, which share none, so that the reference's own error is known; it is printed and not
deducted.  Seconds are those of the processor.  Prints a table, writes bench/results/lit_convergence.json.
"""

import argparse

import frames
from measure import save

SCENES = (
    "still", "moving", "turning", "sweep", "slide", "bolt", "bokeh", "wall", "leaves", "fur"
)  # fmt: skip
NEVER = 1000.0  # a threshold that nothing reaches


def reference(scene, samples):
    job = {"module": "lit_scenes", "scene": scene, "runs": 1, "settings": [{"engine": "CYCLES"}]}
    return frames.reference_of_halves(f"lit-{scene}", job, samples, ("lit_scenes.py", "scenes.py"))


def settings(samples):
    kinds = {
        "corners alone": {"engine": "GRANITA", "shading_threshold": NEVER},
        "Granita": {"engine": "GRANITA", "shading_threshold": 0.06},
        "Cycles": {"engine": "CYCLES"},
    }
    return [(kind, {**s, "samples": n}) for n in samples for kind, s in kinds.items()]


def measure(scene, options):
    truth, own = reference(scene, options.reference)
    wanted = settings(options.samples)
    job = {"module": "lit_scenes", "scene": scene, "runs": 1}
    job["settings"] = [setting for _, setting in wanted]
    rows = []
    for (kind, setting), (image, seconds) in zip(wanted, frames.render(job), strict=True):
        error = frames.errors(image, truth)
        row = {"scene": scene, "kind": kind, "samples": setting["samples"], "seconds": seconds}
        rows.append({**row, **error, "reference_error": own})
        print(
            f"| {scene} | {kind} | {setting['samples']} | {seconds:.2f} | {error['rmse']:.5f} "
            f"| {error['percentile']:.4f} | {own:.5f} |",
            flush=True,
        )
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes", nargs="+", default=SCENES, choices=SCENES)
    parser.add_argument("--samples", nargs="+", type=int, default=(16, 64))
    parser.add_argument("--reference", type=int, default=2048)
    options = parser.parse_args()
    print("| scene | | samples | seconds | RMSE | 99.9 % | the reference's own RMSE |")
    print("|---|---|---|---|---|---|---|")
    save("lit_convergence", [row for scene in options.scenes for row in measure(scene, options)])


if __name__ == "__main__":
    main()
