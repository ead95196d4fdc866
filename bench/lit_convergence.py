# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit pictures, seconds against error: Granita as it comes, with corners alone, and Cycles, on the scenes of lit_scenes.py.

    ./dev bench lit_convergence [--scenes still moving ...] [--samples 4 16 64 256] [--reference 1024] [--width 960]
                                [--sheets FOLDER]

One thread each, in turns; equal filter and shutter, no bounces, of Granita nothing but Samples touched.  Errors are against the
mean of two of Cycles' pictures of half the reference's samples, which share none, so that the reference's own error is
known: what is independent of it adds up by squares, and "RMSE" is without it.  Seconds are those of the processor.
Prints tables, writes bench/results/lit_convergence.json, where what is not measured this time keeps its rows, and draws
docs/lit_convergence.svg.  Sheets: of each scene Granita's pictures of 16 and of 64 samples, below them Cycles' of as
many seconds, and what each lacks, enlarged.
"""

import argparse
import math
from pathlib import Path

import figure_files
import frames
import numpy as np
import plot
from measure import save_over
from pictures import srgb

ROOT = Path(__file__).resolve().parent.parent
SCENES = (
    "still", "moving", "turning", "sweep", "slide", "bolt", "bokeh", "wall", "leaves", "fur"
)  # fmt: skip
TARGETS = (0.01, 0.003, 0.001)
DEFAULT, NEVER = 0.06, 1000.0  # Shading Threshold: the add-on's; one that nothing reaches
KINDS = {
    "Granita": {"engine": "GRANITA", "shading_threshold": DEFAULT},
    "corners alone": {"engine": "GRANITA", "shading_threshold": NEVER},
    "Cycles": {"engine": "CYCLES"},
}
SHEET_SAMPLES = (16, 64)
ENLARGED = 8.0  # differences on a sheet


def job_of(scene, width, settings):
    job = {"module": "lit_scenes", "scene": scene, "runs": 1, "settings": settings}
    return job if width == 480 else {**job, "size": [width, width * 9 // 16]}


def reference(scene, options):
    job = job_of(scene, options.width, [{"engine": "CYCLES"}])
    name = f"lit-{scene}-{options.width}"
    return frames.reference_of_halves(name, job, options.reference, ("lit_scenes.py", "scenes.py"))


def settings(samples):
    """[(kind, setting)]; what corners alone tell does not change with samples."""
    return [
        (kind, {**setting, "samples": n})
        for n in samples
        for kind, setting in KINDS.items()
        if kind != "corners alone" or n == 64
    ]


def without(rmse, own):
    """An error by itself: at least a tenth of the reference's, which is not known better."""
    return math.sqrt(max(rmse**2 - own**2, (0.1 * own) ** 2))


def measure(scene, options):
    """The rows of a scene; a sheet of it where one is asked for."""
    truth, own = reference(scene, options)
    wanted = settings(options.samples)
    rendered = frames.render(job_of(scene, options.width, [setting for _, setting in wanted]))
    rows, images = [], {}
    for (kind, setting), (image, seconds) in zip(wanted, rendered, strict=True):
        found = frames.errors(image, truth)
        row = {"scene": scene, "width": options.width, "kind": kind, "samples": setting["samples"]}
        row |= {"seconds": seconds, **found, "reference_error": own}
        rows.append({**row, "rmse": without(found["rmse"], own)})
        images[kind, setting["samples"]] = image
    print_rows(rows)
    if options.sheets:
        draw_sheet(scene, options, truth, rows, images)
    return rows


def print_rows(rows):
    print(f"\n### {rows[0]['scene']}, {rows[0]['width']} wide\n")
    print(f"The reference's own error: {rows[0]['reference_error']:.5f}.\n")
    print("| | samples | seconds | RMSE | 99.9 % | FLIP |")
    print("|---|---|---|---|---|---|")
    for r in rows:
        print(
            f"| {r['kind']} | {r['samples']} | {r['seconds']:.2f} | {r['rmse']:.5f} "
            f"| {r['percentile']:.4f} | {r['flip']:.4f} |"
        )
    print("\n| | Granita | Cycles | times |\n|---|---|---|---|")
    for target in TARGETS:
        ours, theirs = (
            frames.seconds_to(
                target, [(r["seconds"], r["rmse"]) for r in rows if r["kind"] == kind]
            )
            for kind in ("Granita", "Cycles")
        )
        cells = ["never" if s is None else f"{mark}{s:.2f}" for s, mark in (ours, theirs)]
        times = f"{theirs[0] / ours[0]:.1f}" if ours[0] and theirs[0] else "-"
        print(f"| seconds to RMSE {target} | {' | '.join(cells)} | {times} |", flush=True)


def draw_sheet(scene, options, truth, rows, images):
    """Cycles gets the samples that it has time for."""
    seconds = {(r["kind"], r["samples"]): r["seconds"] for r in rows}
    most = max(n for kind, n in seconds if kind == "Cycles")
    a_sample = seconds["Cycles", most] / most
    equal = [max(1, round(seconds["Granita", n] / a_sample)) for n in SHEET_SAMPLES]
    job = job_of(scene, options.width, [{"engine": "CYCLES", "samples": n} for n in equal])
    theirs = [image for image, _ in frames.render(job)]
    ours = [images["Granita", n] for n in SHEET_SAMPLES]
    files = [np.hstack([*of, *(ENLARGED * np.abs(i - truth) for i in of)]) for of in (ours, theirs)]
    options.sheets.mkdir(parents=True, exist_ok=True)
    figure_files.write_png(
        options.sheets / f"{scene}.png", (srgb(np.vstack(files)) * 255 + 0.5).astype(np.uint8)
    )
    print(f"\nSheet: Granita {SHEET_SAMPLES}, Cycles {tuple(equal)} samples.", flush=True)


def draw(rows):
    """All scenes that were ever measured here, as large as most are."""
    panels = []
    for scene in SCENES:
        of = [r for r in rows if r["scene"] == scene and r["width"] == 480]
        curves = {
            kind: [(r["seconds"], r["rmse"]) for r in of if r["kind"] == kind]
            for kind in ("Granita", "Cycles")
        }
        if of:
            panels.append(plot.Panel(scene, curves, TARGETS))
    if panels:
        plot.save(ROOT / "docs" / "lit_convergence.svg", panels, "seconds", "RMSE")


def identity(row):
    return row["scene"], row["width"], row["kind"], row["samples"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes", nargs="+", default=SCENES, choices=SCENES)
    parser.add_argument("--samples", nargs="+", type=int, default=(4, 16, 64, 256))
    parser.add_argument("--reference", type=int, default=1024)
    parser.add_argument("--width", type=int, default=480)
    parser.add_argument("--sheets", type=Path)
    options = parser.parse_args()
    if options.sheets and not set(SHEET_SAMPLES) <= set(options.samples):
        parser.error(f"sheets show {SHEET_SAMPLES} samples")
    for scene in options.scenes:
        rows = save_over("lit_convergence", measure(scene, options), identity)
    draw(rows)


if __name__ == "__main__":
    main()
