# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands still costs export nothing: neither at more knots nor, with Persistent Data, in the next frame.

    ./dev bench export_cost [--runs 5] [--python PYTHON]

PYTHON: one that has Blender as a module, instead of the `blender` that is installed.  Seconds of the exporting thread,
medians.  Prints a Markdown table and writes bench/results/export_cost.json.
"""

import argparse
import statistics

import frames
import measure


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--python")
    options = parser.parse_args()
    seconds = frames.ask("time_export.py", {"runs": options.runs}, options.python)
    table = measure.Table()
    table.header()
    few, many = (statistics.median(seconds["knots"][count]) for count in ("3", "17"))
    what = f"1,000 static objects and one that turns: 17 knots ({many:.3f} s) over 3"
    table.row(what, many / few, 1.3)
    first, later = (
        statistics.median(run[frame] for run in seconds["instances"]) for frame in (0, -1)
    )
    what = f"100,000 instances that stand and one thing that moves: fourth frame over the first ({first:.2f} s)"
    table.row(what, later / first, 0.05, "{:.3f}")
    table.save("export_cost")


if __name__ == "__main__":
    main()
