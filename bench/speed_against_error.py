# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole frames, seconds against error: three kinds of sampling, with few samples at coarser dicing too, and Cycles, on
the scenes of scenes.py.

    ./dev bench speed_against_error [--runs 1] [--scenes spheres lens lit feathers grass] [--most SAMPLES] [--clock wall]

One thread each, in turns, medians; equal filter and shutter, no bounces; frames as large as scenes.py makes them.  Errors
are against Cycles' picture of many samples, rendered once (25 minutes of one core in all) and kept in the user's cache;
its own error is printed and not deducted.  Grass is
held against the mean of Cycles' stills over the shutter as well: Cycles' moving ribbons are not that.  Seconds are those of the processor unless `--clock wall`; on an idle machine
they are the same.  Prints tables, writes bench/results/speed_against_error.json, where what is not measured this
time keeps its rows, and draws docs/speed_against_error.svg.
"""

import argparse
from pathlib import Path

import frames
import plot
from measure import save_over

ROOT = Path(__file__).resolve().parent.parent
SCENES = ("spheres", "lens", "lit", "feathers", "grass")
TARGETS = (0.01, 0.003)
STILLS = "grass, stills"  # the same pictures against another reference
REFERENCE = {"spheres": 2048, "lens": 2048, "lit": 1536, "feathers": 2048, "grass": 2048}
# Samples of each kind by dicing rate.
SAMPLES = {
    "INDEPENDENT": {1: (4, 8, 16, 64, 256), 2: (4, 8, 16), 4: (8, 16, 32)},
    "INTERLEAVED": {1: (16, 64, 256)},
    "REGULAR": {1: (1, 4)},  # times the passes that motion and lens ask for
    "CYCLES": {1: (16, 64, 256)},
}
ALL_CURVES = [(kind, rate) for kind, rates in SAMPLES.items() for rate in rates]
# Where light is sampled its samples grow with the others.
LIGHT_SAMPLES = {1: 4, 4: 4, 8: 4, 16: 4, 32: 4, 64: 8, 256: 16}


def settings(most):
    """Jobs of render_frames.py, each with its (kind, dicing rate, samples)."""
    frames_of = [
        (kind, rate, samples)
        for kind, rates in SAMPLES.items()
        for rate, counts in rates.items()
        for samples in counts
        if samples <= most
    ]
    return [(frame, setting(*frame)) for frame in frames_of]


def setting(kind, rate, samples):
    if kind == "CYCLES":
        return {"engine": "CYCLES", "samples": samples}
    return {
        "engine": "GRANITA",
        "samples": samples,
        "sampling": kind,
        "dicing_rate": rate,
        "light_samples": LIGHT_SAMPLES[samples],
    }


def nanoseconds(rows):
    """What one more sample a pixel costs, from the fewest to the most; REGULAR multiplies them by its passes."""
    first, last = rows[0], rows[-1]
    samples = (last["samples"] - first["samples"]) * first["pixels"]
    return (last["seconds"] - first["seconds"]) / samples * 1e9


def soonest(target, rows):
    """(seconds until an error, mark, dicing rate) at the dicing rate that gets there first."""
    found = []
    for rate, of in by_rate(rows).items():
        seconds, mark = frames.seconds_to(target, [(r["seconds"], r["rmse"]) for r in of])
        # What is extended from few samples at a coarse rate was not seen.
        if seconds is not None and (rate == 1 or mark != "~"):
            found.append((seconds, mark, rate))
    return min(found, default=(None, "", 1))


def by_rate(rows):
    rates = {}
    for row in rows:
        rates.setdefault(row["rate"], []).append(row)
    return rates


def identity(row):
    return row["scene"], row["kind"], row["rate"], row["samples"]


def measure(scene, options):
    """Prints the tables of a scene, one for each reference, and returns their rows."""
    references = {scene: frames.reference(scene, REFERENCE[scene], SCENES)}
    if STILLS.startswith(scene):
        references[STILLS] = frames.still_reference(scene, REFERENCE[scene], SCENES)
    job = {"module": "scenes", "scene": scene, "runs": options.runs}
    kinds, job["settings"] = zip(*settings(options.most), strict=True)
    rendered = list(zip(kinds, frames.render(job, options.clock), strict=True))
    measured = []
    for name, (truth, own_error) in references.items():
        height, width = truth.shape[:2]
        print(f"\n### {name}, {width} x {height}\n\nThe reference's own error: {own_error:.5f}.\n")
        rows = []
        for (kind, rate, samples), (image, seconds) in rendered:
            row = {"scene": name, "kind": kind, "rate": rate, "samples": samples}
            row |= {"seconds": seconds, "pixels": width * height}
            rows.append({**row, **frames.errors(image, truth)})
        print_tables(rows)
        measured += rows
    return measured


def print_tables(rows):
    print("| sampling | dicing rate | samples | seconds | RMSE | 99.9 % | FLIP |")
    print("|---|---|---|---|---|---|---|")
    for r in rows:
        print(
            f"| {r['kind']} | {r['rate']} | {r['samples']} | {r['seconds']:.2f} | {r['rmse']:.5f} "
            f"| {r['percentile']:.4f} | {r['flip']:.4f} |"
        )
    kinds = {kind: [r for r in rows if r["kind"] == kind] for kind in SAMPLES}
    print(f"\n| | {' | '.join(kinds)} | Cycles over INDEPENDENT |")
    print("|---|" + "---|" * (len(kinds) + 1))
    for target in TARGETS:
        found = {kind: soonest(target, of) for kind, of in kinds.items()}
        cells = [
            "never" if s is None else f"{mark}{s:.2f}" + (f" (dicing {rate})" if rate != 1 else "")
            for s, mark, rate in found.values()
        ]
        print_ratio(f"seconds to RMSE {target}", cells, {k: s for k, (s, *_) in found.items()})
    costs = {kind: nanoseconds(by_rate(of)[1]) for kind, of in kinds.items()}
    print_ratio("one more sample a pixel, ns", [f"{c:.0f}" for c in costs.values()], costs)


def print_ratio(what, cells, values):
    ours, theirs = values["INDEPENDENT"], values["CYCLES"]
    ratio = f"{theirs / ours:.1f}" if ours and theirs else "-"
    print(f"| {what} | {' | '.join(cells)} | {ratio} |", flush=True)


def name(kind, rate):
    return kind if rate == 1 else f"{kind}, dicing rate {rate}"


def draw(rows):
    """All scenes that were ever measured here."""
    panels = []
    for scene in (*SCENES, STILLS):
        curves = {}
        for row in (r for r in rows if r["scene"] == scene):
            curves.setdefault((row["kind"], row["rate"]), []).append((row["seconds"], row["rmse"]))
        if curves:
            named = {name(*curve): curves[curve] for curve in ALL_CURVES if curve in curves}
            panels.append(plot.Panel(scene, named, TARGETS))
    plot.save(ROOT / "docs" / "speed_against_error.svg", panels, "seconds", "RMSE")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--scenes", nargs="+", default=SCENES)
    parser.add_argument("--most", type=int, choices=(64, 256), default=256)
    parser.add_argument("--clock", choices=("processor", "wall"), default="processor")
    options = parser.parse_args()
    for scene in options.scenes:
        rows = save_over("speed_against_error", measure(scene, options), identity)
    draw(rows)


if __name__ == "__main__":
    main()
