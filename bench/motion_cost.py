# SPDX-License-Identifier: GPL-3.0-or-later
"""What motion blur costs a whole frame: blur on over blur off at equal samples, Granita and Cycles.

    ./dev bench motion_cost [--runs 3] [--samples 64] [--size 960 540] [--clock wall]
        [--files demo bend camera instances snake morph]

The demo, as ordinary a moving scene as there is here (textures, lights, lens), and animated files of
tests/images/assets/moving with their own materials and lights; one thread each, in turns, medians of the whole frame,
export included.  Prints a Markdown table and writes bench/results/motion_cost.json.
"""

import argparse

import frames
import measure

LIMIT = 1.25


def seconds(file, options):
    """{engine: (seconds with blur, without)}"""
    settings = []
    for engine in ("GRANITA", "CYCLES"):
        for still in ({}, {"shutter": 0}):
            settings.append({"engine": engine, "samples": options.samples, **still})
    module = "demo" if file == "demo" else "moving_files"
    job = {"module": module, "scene": file, "variant": "lit", "settings": settings}
    job |= {"runs": options.runs, "size": options.size}
    taken = [took for _, took in frames.render(job, options.clock)]
    return {"GRANITA": taken[:2], "CYCLES": taken[2:]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--size", type=int, nargs=2, default=(960, 540))
    parser.add_argument(
        "--files", nargs="+", default=("demo", "bend", "camera", "instances", "snake", "morph")
    )
    parser.add_argument("--clock", choices=("processor", "wall"), default="processor")
    options = parser.parse_args()
    table = measure.Table()
    table.header()
    for file in options.files:
        taken = seconds(file, options)
        blurred, still = taken["CYCLES"]
        what = f"{file}: blur on over off (Cycles {blurred / still:.2f}, {blurred:.2f} s)"
        blurred, still = taken["GRANITA"]
        table.row(f"{what}, {blurred:.2f} s", blurred / still, LIMIT)
    table.save("motion_cost")


if __name__ == "__main__":
    main()
