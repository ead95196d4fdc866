# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole frames, seconds against error: three kinds of sampling and Cycles, on the scenes of scenes.py.

    ./dev bench speed_against_error [--runs 1] [--scenes spheres lens lit feathers grass] [--clock wall] [--reference 4096]

320 x 180 pixels, one thread each, in turns, medians; equal filter and shutter, no bounces.  Errors are against Cycles'
picture of 4096 samples, which is rendered once (a quarter of an hour) and kept in the user's cache.  Seconds are those
of the processor unless `--clock wall`; on an idle machine they are the same.  Prints tables, writes
bench/results/speed_against_error.json and draws docs/speed_against_error.svg.
"""

import argparse
import json
import math
from pathlib import Path

import frames
import plot

ROOT = Path(__file__).resolve().parent.parent
SCENES = ("spheres", "lens", "lit", "feathers", "grass")
TARGETS = (0.01, 0.003)
WIDTH, HEIGHT = 320, 180  # of scenes.py, which only Blender can import
SAMPLES = {
    "INDEPENDENT": (16, 64, 256, 1024),
    "INTERLEAVED": (16, 64, 256),
    "REGULAR": (4, 16),  # times the passes that motion and lens ask for
    "CYCLES": (16, 64, 256, 1024),
}
# Where light is sampled its samples grow with the others.
LIGHT_SAMPLES = {4: 4, 16: 4, 64: 8, 256: 16, 1024: 32}
FEWER = {"feathers": 256}  # the most samples of a scene


def settings(scene):
    result = []
    for kind, counts in SAMPLES.items():
        for samples in counts:
            if samples > FEWER.get(scene, 1024):
                continue
            if kind == "CYCLES":
                result.append({"engine": "CYCLES", "samples": samples})
            else:
                light = LIGHT_SAMPLES[samples]
                result.append(
                    {
                        "engine": "GRANITA",
                        "samples": samples,
                        "sampling": kind,
                        "light_samples": light,
                    }
                )
    return result


def seconds_to(target, points):
    """(seconds until an error, mark) of [(seconds, error)] by log-log interpolation.

    The mark is "<" where the cheapest frame is good enough already, "~" where the last two frames were extended, and
    None stands for seconds where those no longer improve.
    """
    points = sorted(points)
    if points[0][1] <= target:
        return points[0][0], "<"
    for (s0, e0), (s1, e1) in zip(points, points[1:], strict=False):
        if e1 <= target:
            return s0 * (s1 / s0) ** (math.log(target / e0) / math.log(e1 / e0)), ""
    (s0, e0), (s1, e1) = points[-2:]
    slope = math.log(e1 / e0) / math.log(s1 / s0)
    if slope > -0.2:
        return None, ""
    return s1 * (target / e1) ** (1 / slope), "~"


def nanoseconds(rows):
    """What one more sample a pixel costs, from the fewest to the most; REGULAR multiplies them by its passes."""
    first, last = rows[0], rows[-1]
    samples = (last["samples"] - first["samples"]) * WIDTH * HEIGHT
    return (last["seconds"] - first["seconds"]) / samples * 1e9


def measure(scene, options):
    truth = frames.reference(scene, options.reference, SCENES)
    job = {
        "module": "scenes",
        "scene": scene,
        "runs": options.runs,
        "settings": settings(scene),
    }
    rows = []
    for setting, (image, seconds) in zip(
        job["settings"], frames.render(job, options.clock), strict=True
    ):
        kind = setting.get("sampling", "CYCLES")
        row = {"scene": scene, "kind": kind, "samples": setting["samples"], "seconds": seconds}
        rows.append({**row, **frames.errors(image, truth)})
    return rows


def print_tables(scene, rows):
    print(f"\n### {scene}\n\n| sampling | samples | seconds | RMSE | 99.9 % | FLIP |")
    print("|---|---|---|---|---|---|")
    for r in rows:
        print(
            f"| {r['kind']} | {r['samples']} | {r['seconds']:.2f} | {r['rmse']:.5f} "
            f"| {r['percentile']:.4f} | {r['flip']:.4f} |"
        )
    kinds = {kind: [r for r in rows if r["kind"] == kind] for kind in SAMPLES}
    print(f"\n| | {' | '.join(kinds)} | Cycles over INDEPENDENT |")
    print("|---|" + "---|" * (len(kinds) + 1))
    for target in TARGETS:
        found = {
            kind: seconds_to(target, [(r["seconds"], r["rmse"]) for r in of])
            for kind, of in kinds.items()
        }
        cells = ["never" if s is None else f"{mark}{s:.2f}" for s, mark in found.values()]
        print_ratio(f"seconds to RMSE {target}", cells, {k: s for k, (s, _) in found.items()})
    costs = {kind: nanoseconds(of) for kind, of in kinds.items()}
    print_ratio("one more sample a pixel, ns", [f"{c:.0f}" for c in costs.values()], costs)


def print_ratio(what, cells, values):
    ours, theirs = values["INDEPENDENT"], values["CYCLES"]
    ratio = f"{theirs / ours:.1f}" if ours and theirs else "-"
    print(f"| {what} | {' | '.join(cells)} | {ratio} |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--scenes", nargs="+", default=SCENES)
    parser.add_argument("--clock", choices=("processor", "wall"), default="processor")
    parser.add_argument("--reference", type=int, default=4096)
    options = parser.parse_args()
    rows = []
    for scene in options.scenes:
        rows += measure(scene, options)
        print_tables(scene, [r for r in rows if r["scene"] == scene])
    (ROOT / "bench" / "results").mkdir(exist_ok=True)
    file = ROOT / "bench" / "results" / "speed_against_error.json"
    file.write_text(json.dumps(rows, indent=1) + "\n")
    panels = [
        plot.Panel(
            scene,
            {
                kind: [
                    (r["seconds"], r["rmse"])
                    for r in rows
                    if (r["scene"], r["kind"]) == (scene, kind)
                ]
                for kind in SAMPLES
            },
            TARGETS,
        )
        for scene in options.scenes
    ]
    plot.save(ROOT / "docs" / "speed_against_error.svg", panels, "seconds", "RMSE")


if __name__ == "__main__":
    main()
