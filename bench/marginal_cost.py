# SPDX-License-Identifier: GPL-3.0-or-later
"""What one more sample a pixel costs: the slope of a whole frame's seconds from 16 to 256 samples, one thread.

    ./dev bench marginal_cost [--runs 5]

The chapter's figure 9.9.  Limits: a fifth of the better of Aqsis and Cycles, each measured on its own frame of the same
kind (47, 155, 226, 505 and 1,430 ns).  Medians, in turns, processor seconds.  Prints a Markdown table and writes
bench/results/marginal_cost.json.
"""

import argparse

import measure
import snapshot_scenes as scenes

CASES = {
    "spheres, still": (scenes.spheres, 0.0, 9.4),
    "spheres, 20 px": (scenes.spheres, 20.0, 31.0),
    "spheres, 100 px": (scenes.spheres, 100.0, 45.0),
    "feathers, still": (scenes.feathers, 0.0, 101.0),
    "feathers, moving": (scenes.feathers, 0.5, 286.0),
}
FEW, MANY = 16, 256


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    cases = {
        (name, n): build(motion, samples=n)
        for name, (build, motion, _) in CASES.items()
        for n in (FEW, MANY)
    }
    taken = measure.interleaved(cases, measure.frame_seconds, options.runs)
    table = measure.Table()
    table.header()
    samples = (MANY - FEW) * scenes.WIDTH * scenes.HEIGHT
    for name, (_, _, limit) in CASES.items():
        slope = (taken[name, MANY] - taken[name, FEW]) / samples * 1e9
        table.row(f"{name}, ns a sample", slope, limit, "{:.1f}")
    table.save("marginal_cost")


if __name__ == "__main__":
    main()
