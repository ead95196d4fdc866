# SPDX-License-Identifier: GPL-3.0-or-later
"""Files by others with light that bounces, beside Cycles: what differs, and how long it takes.

    ./dev bench bounced_files FILE... [--reference 512] [--pictures FOLDER]

opened_files.py tells what it opens and what it adds.  240 x 135 pixels, one thread each, four bounces, no clamps, no Filter
Glossy; errors are against the mean of two of Cycles' pictures of half the reference's samples, whose own error is printed
and not deducted.  Seconds are those of the processor; the last column is how many times longer Cycles takes for an RMSE as
small.  Writes bench/results/bounced_files.json; with --pictures Granita | Cycles | four times the difference of each file.
"""

import argparse
import hashlib
from pathlib import Path

import frames
import numpy as np
from measure import save

BOUNCES = 4
SIZE = (240, 135)
SETTINGS = [
    {"engine": "GRANITA", "samples": 16, "light_samples": 16},
    {"engine": "CYCLES", "samples": 32},
]


def job_of(path, settings):
    bounced = [{**setting, "bounces": BOUNCES} for setting in settings]
    return {
        "module": "opened_files",
        "scene": str(path),
        "runs": 1,
        "size": SIZE,
        "settings": bounced,
    }


def reference(path, samples):
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
    job = job_of(path, [{"engine": "CYCLES"}])
    return frames.reference_of_halves(
        f"file-{path.stem}-{digest}", job, samples, ("opened_files.py",)
    )


def measure(path, options):
    truth, own = reference(path, options.reference)
    made = frames.render(job_of(path, SETTINGS))
    (ours, cycles) = [
        {"seconds": s, "mean": float(i.mean() / truth.mean() - 1), **frames.errors(i, truth)}
        for i, s in made
    ]
    due = ours["seconds"] * ours["rmse"] ** 2
    times = cycles["seconds"] * cycles["rmse"] ** 2 / due if due > 0 else float("inf")
    print(
        f"| {path.stem} | {ours['rmse']:.4f} | {own:.4f} | {ours['flip']:.3f} | {cycles['flip']:.3f} "
        f"| {100 * ours['mean']:+.1f} % | {ours['seconds']:.1f} | {cycles['seconds']:.1f} | {times:.1f} |",
        flush=True,
    )
    if options.pictures:
        difference = 0.5 + 2 * (made[0][0] - truth)
        picture = np.concatenate([made[0][0], truth, difference], 1)
        frames.save_png(Path(options.pictures) / f"{path.stem}.png", picture)
    return {
        "file": path.name,
        "granita": ours,
        "cycles": cycles,
        "reference_rmse": own,
        "times": times,
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--reference", type=int, default=512)
    parser.add_argument("--pictures")
    options = parser.parse_args()
    if not options.files:  # as `./dev bench` runs it
        print("bounced_files measures the files that are named: none is")
        return
    print(
        "| file | RMSE | the reference's | FLIP | of Cycles, 32 samples | mean | seconds | of Cycles, 32 samples | times |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    rows = []
    for path in options.files:
        try:
            rows.append(measure(path.resolve(), options))
        except RuntimeError as error:
            print(f"| {path.stem} | {str(error).strip().splitlines()[-1]} |", flush=True)
    save("bounced_files", rows)


if __name__ == "__main__":
    main()
