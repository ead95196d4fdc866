# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory, threads, open files and seconds over the frames of one rendered animation, with and without Persistent Data.

    ./dev bench memory_curve [--frames 300] [--bounces NONE] [--python PYTHON]

PYTHON: one that has Blender as a module, instead of the `blender` that is installed.  The heap's slope is taken after the
first fifty frames; what is resident goes up and down with what the allocator gives back, so its highest fifties are
compared; of seconds the medians of fifty frames.  With bounces (NONE, FAST, FULL) the file is memory_curve_bounces.json, and nothing is
drawn.  Prints a Markdown table, writes bench/results/memory_curve.json and draws docs/memory_curve.svg.
"""

import argparse
from pathlib import Path

import frames
import measure
import numpy as np
import plot

ROOT = Path(__file__).resolve().parent.parent
WARM_UP = 50  # frames
MOST_KB = 1.0  # of the heap, a frame


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--bounces", default="NONE", choices=("NONE", "FAST", "FULL"))
    parser.add_argument("--python")
    options = parser.parse_args()
    table, curves = measure.Table(), {}
    table.header()
    for persistent in (False, True):
        job = {"frames": options.frames, "persistent": persistent, "bounces": options.bounces}
        taken = frames.ask("render_animation.py", job, options.python)
        with_data = ", persistent data" if persistent else ""
        for kind in ("threads", "files"):
            values = taken.pop(kind)
            table.row(
                f"{kind}{with_data}: more than after {WARM_UP} frames",
                values[-1] - values[WARM_UP],
                0,
                "{:.0f}",
            )
        seconds = taken.pop("seconds")
        early, late = (
            np.median(part) for part in (seconds[WARM_UP : 2 * WARM_UP], seconds[-WARM_UP:])
        )
        table.row(
            f"seconds a frame{with_data}: last {WARM_UP} frames over the second {WARM_UP}",
            late / early,
            1.2,
        )
        for kind, values in taken.items():
            if not values:
                continue
            name = kind + with_data
            number = np.arange(1, len(values) + 1)
            if kind == "heap":
                slope = np.polyfit(number[WARM_UP:], values[WARM_UP:], 1)[0] / 1e3
                table.row(f"{name}: KB a frame, of {values[-1] / 1e6:.0f} MB", slope, MOST_KB)
            else:
                early, late = max(values[WARM_UP : 2 * WARM_UP]), max(values[-WARM_UP:])
                table.row(
                    f"{name}: last {WARM_UP} frames over the second {WARM_UP}", late / early, 1.05
                )
            curves[name] = list(zip(number.tolist(), (np.array(values) / 1e6).tolist()))
    if options.bounces != "NONE":
        table.save("memory_curve_bounces")
        return
    table.save("memory_curve")
    panel = plot.Panel("Memory after each frame of an animation", curves, from_origin=True)
    plot.save(ROOT / "docs" / "memory_curve.svg", [panel], "frame", "MB")


if __name__ == "__main__":
    main()
