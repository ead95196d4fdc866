# SPDX-License-Identifier: GPL-3.0-or-later
"""A subdivided cage of a million faces that moves (hero_scene.py), beside Cycles in the same Blender.

    ./dev bench hero [--runs 3]

Both render 960 by 540 pixels of 16 samples without bounces on all cores, in turns.  Prints medians of wall and of
processor seconds of the whole frame, Blender's own subdivision included, and writes bench/results/hero.json.
"""

import argparse
import statistics
import tempfile

import frames
import measure


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3)
    runs = parser.parse_args().runs
    engines = ("GRANITA", "CYCLES")
    settings = [{"engine": engine, "samples": 16} for engine in engines]
    job = {"module": "hero_scene", "runs": runs, "settings": settings}
    with tempfile.TemporaryDirectory() as folder:
        seconds = frames.run_job("render_frames.py", job, folder)
    rows = []
    print("| engine | wall, s | processor, s |\n|---|---|---|")
    for engine, taken in zip(engines, seconds):
        wall, processor = (statistics.median(run[i] for run in taken) for i in (0, 1))
        rows.append({"engine": engine, "wall": wall, "processor": processor})
        print(f"| {engine} | {wall:.1f} | {processor:.1f} |")
    measure.save("hero", rows)


if __name__ == "__main__":
    main()
