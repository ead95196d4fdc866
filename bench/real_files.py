# SPDX-License-Identifier: GPL-3.0-or-later
"""Eight animated files by others, seconds and error beside Cycles.

    ./dev bench real_files [--runs 1] [--samples 64] [--scenes bend snake ...] [--variants emission lit] [--clock wall] [--pictures]

240 x 135 pixels, one thread each, in turns, medians; scenes and stored references are those of
tests/images/moving_files.py (Cycles, 4096 samples).  RMSE is over the pixels that blur changes, FLIP over the frame.
Prints a Markdown table, writes bench/results/real_files.json and with --pictures docs/images/real_files.png:
for each file Granita, Cycles at the same samples, the reference, and four times Granita's error.
"""

import argparse
from pathlib import Path

import frames
import numpy as np
from measure import save

ROOT = Path(__file__).resolve().parent.parent
REFERENCES = ROOT / "tests" / "images" / "references"


def reference(scene, variant):
    """(truth, where blur changes pixels)"""
    stored = np.load(REFERENCES / f"moving_{scene}.npz")
    return stored[variant].astype(np.float32), stored["blurred"]


def stored_scenes(variant):
    """Those whose reference was rendered (tests/images/make_moving_references.py)."""
    files = sorted(REFERENCES.glob("moving_*.npz"))
    return [f.stem.removeprefix("moving_") for f in files if variant in np.load(f)]


def masked_rmse(image, truth, mask):
    return float(np.sqrt(np.mean((image - truth)[mask] ** 2)))


def measure(scene, variant, options):
    """(row of the table, pictures side by side)"""
    truth, blurred = reference(scene, variant)
    job = {"module": "moving_files", "scene": scene, "variant": variant, "runs": options.runs}
    ours = {"engine": "GRANITA", "samples": options.samples, "light_samples": 8}
    # The references have Cycles' seed 0.
    job |= {"seed": 1, "settings": [ours, {"engine": "CYCLES", "samples": options.samples}]}
    row = {"scene": scene, "variant": variant, "samples": options.samples}
    pictures = []
    for name, (image, seconds) in zip(("granita", "cycles"), frames.render(job, options.clock)):
        flip = frames.errors(image, truth)["flip"]
        rmse = masked_rmse(image, truth, blurred)
        row[name] = {"seconds": seconds, "rmse": rmse, "flip": flip}
        pictures.append(image)
    strip = [*pictures, truth, 4 * np.abs(pictures[0] - truth)]
    return row, np.concatenate(strip, 1)


def print_row(row):
    g, c = row["granita"], row["cycles"]
    print(
        f"| {row['scene']}, {row['variant']} | {g['seconds']:.2f} | {g['rmse']:.4f} | {g['flip']:.4f} "
        f"| {c['seconds']:.2f} | {c['rmse']:.4f} | {c['flip']:.4f} | {c['seconds'] / g['seconds']:.2f} |",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--scenes", nargs="+")
    parser.add_argument("--variants", nargs="+", default=("emission", "lit"))
    parser.add_argument("--clock", choices=("processor", "wall"), default="processor")
    parser.add_argument("--pictures", action="store_true")
    options = parser.parse_args()
    rows, strips = [], []
    print("| file | Granita, s | RMSE | FLIP | Cycles, s | RMSE | FLIP | Cycles takes, times |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for variant in options.variants:
        for scene in options.scenes or stored_scenes(variant):
            row, strip = measure(scene, variant, options)
            rows.append(row)
            strips.append(strip)
            print_row(row)
    save("real_files", rows)
    if options.pictures:
        frames.save_png(ROOT / "docs" / "images" / "real_files.png", np.concatenate(strips))


if __name__ == "__main__":
    main()
