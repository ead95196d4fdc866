# SPDX-License-Identifier: GPL-3.0-or-later
"""Things of 10,000 faces and four pixels each (crowd_scenes.py), beside Cycles in the same Blender.

    ./dev bench crowd [--runs 3]

Both render 960 by 540 pixels of 16 samples without bounces on all cores, in turns.  Prints medians of wall and of
processor seconds of the whole frame, and writes bench/results/crowd.json.
"""

import argparse
import statistics
import tempfile

import frames
import measure

SCENES = ("10,000 things", "100,000 things", "100,000 things that move")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3)
    runs = parser.parse_args().runs
    engines = ("GRANITA", "CYCLES")
    settings = [{"engine": engine, "samples": 16} for engine in engines]
    rows = []
    print("| scene | engine | wall, s | processor, s |\n|---|---|---|---|")
    for scene in SCENES:
        job = {"module": "crowd_scenes", "scene": scene, "runs": runs, "settings": settings}
        with tempfile.TemporaryDirectory() as folder:
            seconds = frames.run_job("render_frames.py", job, folder)
        for engine, taken in zip(engines, seconds):
            wall, processor = (statistics.median(run[i] for run in taken) for i in (0, 1))
            rows.append({"scene": scene, "engine": engine, "wall": wall, "processor": processor})
            print(f"| {scene} | {engine} | {wall:.1f} | {processor:.1f} |", flush=True)
    measure.save("crowd", rows)


if __name__ == "__main__":
    main()
