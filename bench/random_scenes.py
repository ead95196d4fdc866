# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes by chance with light that bounces, beside Cycles: what nobody has thought of.

    ./dev bench random_scenes [--seeds 1 2 3] [--reference 128] [--python PYTHON] [--pictures FOLDER]

random_stage.py makes the scenes (of random_things.py, random_light.py, random_materials.py, random_patterns.py),
240 x 135 pixels, one thread each, four bounces, Blender's own clamps.  FLIP is over the frame; a block is
12 x 12 pixels, as a screen shows it: the mean of one in which noise is gone differs where the engines do, and the widest gap
is printed beside that of the reference's own halves.  With --pictures Granita | Cycles | four times the difference, on a
dark ground.
Writes bench/results/random_scenes.json.
"""

import argparse
from pathlib import Path

import frames
import numpy as np
import pictures
from measure import save

BOUNCED = {"bounces": 4, "tamed": True}
GRANITA = {"engine": "GRANITA", "samples": 64, "light_samples": 8, **BOUNCED}
BLOCK = 12
SEEDS = range(1, 5)


def blocks(image):
    """[rows, columns, 3] of whole blocks."""
    rows, columns = (side // BLOCK for side in image.shape[:2])
    whole = pictures.srgb(image)[: rows * BLOCK, : columns * BLOCK]
    return whole.reshape(rows, BLOCK, columns, BLOCK, 3).mean((1, 3))


def widest_gap(a, b):
    """(of a block's mean, column and row of its first pixel)"""
    gap = np.abs(blocks(a) - blocks(b)).max(-1)
    row, column = np.unravel_index(gap.argmax(), gap.shape)
    return float(gap.max()), (int(column) * BLOCK, int(row) * BLOCK)


def measure(seed, options):
    half = {"engine": "CYCLES", "samples": options.reference // 2, **BOUNCED}
    job = {"module": "random_stage", "scene": str(seed), "runs": 1}
    # In one process: hair of particles lies elsewhere in another.
    job["settings"] = [GRANITA, {**half, "seed": 1}, {**half, "seed": 2}]
    (image, seconds), first, second = frames.render(job, python=options.python)
    truth = (first[0] + second[0]) / 2
    gap, place = widest_gap(image, truth)
    row = {
        "seed": seed,
        **frames.errors(image, truth),
        "mean": float(image.mean() / truth.mean() - 1),
        "gap": gap,
        "place": place,
        "reference_gap": widest_gap(first[0], second[0])[0],
        "seconds": seconds,
        "cycles_seconds": first[1] + second[1],
    }
    print(
        f"| {seed} | {row['rmse']:.4f} | {row['flip']:.3f} | {100 * row['mean']:+.1f} % | {gap:.3f} "
        f"| {place} | {row['reference_gap']:.3f} | {seconds:.1f} | {row['cycles_seconds']:.1f} |",
        flush=True,
    )
    if options.pictures:
        strip = np.concatenate([image, truth, np.clip(0.2 + 4 * (image - truth), 0, 1)], 1)
        frames.save_png(Path(options.pictures) / f"random_{seed}.png", strip)
    return row


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS)
    parser.add_argument("--reference", type=int, default=128)
    parser.add_argument("--python")
    parser.add_argument("--pictures")
    options = parser.parse_args()
    print(
        "| seed | RMSE | FLIP | mean | widest gap of a block | at | of the reference's halves | seconds | of the reference |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    rows = []
    for seed in options.seeds:
        try:
            rows.append(measure(seed, options))
        except RuntimeError as error:
            print(f"| {seed} | {str(error).strip().splitlines()[-1]} |", flush=True)
    save("random_scenes", rows)


if __name__ == "__main__":
    main()
