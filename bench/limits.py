# SPDX-License-Identifier: GPL-3.0-or-later
"""More of one thing than an artist has (limit_scenes.py), beside Cycles in the same Blender.

    ./dev bench limits [--rows TEXT] [--runs 1] [--engines GRANITA CYCLES]

Each frame is rendered in a Blender of its own, by turns, with 16 samples and without bounces, on all cores.  Prints
medians of wall and processor seconds of the whole frame, Blender's own evaluation included, and the most
memory that the process held; writes bench/results/limits.json.  --rows: those whose names hold the text.
"""

import argparse
import statistics
import tempfile

import frames
import measure

ROWS = {
    "100,000 things of 100 faces that move": 16,
    "1 M hairs": 16,
    "40 textures of 4096 x 4096": 16,
    "2,000 textures of 256 x 256": 16,
    "n-gon of 100,000 corners": 16,
    "2,000 nodes": 16,
    "5 M faces": 16,
    "2 M faces that are displaced": 16,
    "4 faces a pixel": 16,
    "700 faces a pixel": 16,
    "200 AOVs": 16,
    "50 view layers": 16,
    "8192 x 8192 pixels": 4,
    "16384 x 16384 pixels": 4,
}


def frame(scene, engine, samples):
    """(wall seconds, processor seconds, peak GB)"""
    job = {"module": "limit_scenes", "scene": scene, "runs": 1}
    job["settings"] = [{"engine": engine, "samples": samples}]
    with tempfile.TemporaryDirectory() as folder:
        ((taken,),) = frames.run_job("render_frames.py", job, folder)
    return taken[0], taken[1], taken[2] / 1e9


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", default="")
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--engines", nargs="+", default=["GRANITA", "CYCLES"])
    arguments = parser.parse_args()
    rows = []
    print("| scene | engine | wall, s | processor, s | GB |\n|---|---|---|---|---|")
    for scene, samples in ROWS.items():
        if arguments.rows not in scene:
            continue
        taken = {engine: [] for engine in arguments.engines}
        for _ in range(arguments.runs):
            for engine, runs in taken.items():
                runs.append(frame(scene, engine, samples))
        for engine, runs in taken.items():
            wall, processor, peak = (statistics.median(column) for column in zip(*runs))
            rows.append({"scene": scene, "engine": engine, "wall": wall})
            rows[-1].update({"processor": processor, "gigabytes": peak})
            print(f"| {scene} | {engine} | {wall:.1f} | {processor:.1f} | {peak:.2f} |", flush=True)
    measure.save("limits", rows)


if __name__ == "__main__":
    main()
