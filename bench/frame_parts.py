# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame in N parts: how long the longest takes beside the whole frame, export and saving included.

Parts are cut by place, and by what a coarse look at the frame says of their cost.

    ./dev bench frame_parts [--counts 1 2 4 8 16 32 64] [--scene demo] [--size 960 540] [--samples 64]
        [--bounces FULL]

One thread, processor seconds: each part stands for a machine of its own.  What every part does again is what its least one
takes that sees nothing: the export, the opening, the ray scene.  Prints a Markdown table, writes bench/results/frame_parts.json and
draws docs/frame_parts.svg.
"""

import argparse
from pathlib import Path

import frames
import measure
import plot

ROOT = Path(__file__).resolve().parent.parent


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--counts", type=int, nargs="+", default=[1, 2, 4, 8, 16, 32, 64])
    parser.add_argument("--scene", default="demo")
    parser.add_argument("--size", type=int, nargs=2, default=(960, 540))
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--bounces", default="NONE", choices=["NONE", "FULL"])
    options = parser.parse_args()
    module = "demo" if options.scene == "demo" else "lit_scenes"
    job = {"module": module, "scene": options.scene, "size": options.size}
    job |= {"samples": options.samples, "bounces": options.bounces, "counts": options.counts}
    taken = frames.ask("render_parts.py", job)
    whole = max(taken[str(options.counts[0])]["parts"])
    rows, measured, by_cost, ideal = [], [], [], []
    print(
        "| parts | longest, s | by cost, s | the look, s | ideal, s | all together, s | shortest, s | merging, s |"
    )
    print("|---" * 8 + "|")
    for count in options.counts:
        parts = taken[str(count)]["parts"]
        row = {"parts": count, "longest": max(parts), "by_cost": max(taken[str(count)]["by_cost"])}
        row |= {"look": taken[str(count)]["look"], "ideal": whole / count, "sum": sum(parts)}
        row |= {"shortest": min(parts), "merge": taken[str(count)]["merge"]}
        rows.append(row)
        measured.append((count, row["longest"]))
        by_cost.append((count, row["by_cost"]))
        ideal.append((count, row["ideal"]))
        numbers = " | ".join(f"{row[key]:.2f}" for key in list(row)[1:])
        print(f"| {count} | {numbers} |", flush=True)
    measure.save("frame_parts", rows)
    panel = plot.Panel(
        "Seconds of the longest part", {"by place": measured, "by cost": by_cost, "ideal": ideal}
    )
    plot.save(ROOT / "docs" / "frame_parts.svg", [panel], "parts", "s")


if __name__ == "__main__":
    main()
