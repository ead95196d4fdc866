# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that are stopped at random times: under a frame's name there is a whole file or none.

    ./dev bench cancels [--runs 50] [--seed 1] [--ways Esc SIGINT ...]

Float OpenEXR files of a small moving scene, an animation of 60 frames, stopped by each way of stop_ways.py in turn up to
a second and a half after its first frame.  Looks at exit codes, at each file under a frame's name, at processes that are
left, and where a file has the name of an unfinished one whether the next render removes it.  Prints a Markdown table and
what is wrong, writes bench/results/cancels.json; ends with 1 where something is.
"""

import argparse
import random
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import measure
import stop_ways

TESTS = Path(__file__).resolve().parent.parent / "tests" / "blender"
sys.path.insert(0, str(TESTS))
import exr  # noqa: E402

UNFINISHED = ".unfinished-"


def processes_of(folder):
    """Command lines that name the folder, a moment after: a killed one is not gone at once."""
    for _ in range(20):
        lines = []
        for path in Path("/proc").glob("[0-9]*/cmdline"):
            try:
                lines.append(path.read_bytes().replace(b"\0", b" ").decode(errors="replace"))
            except OSError:
                continue  # it has ended
        found = [line for line in lines if f"{folder}/" in line]
        if not found:
            break
        time.sleep(0.1)
    return found


def is_whole(path):
    try:
        exr.read(path)
    except Exception:
        return False
    return True


def look(blend, out, row):
    """Counts the files that a stopped render left; yields what is wrong with them."""
    for path in sorted(out.iterdir()):
        if path.name.startswith(UNFINISHED):
            row["unfinished files"] += 1
            continue
        if is_whole(path):
            row["whole files"] += 1
        else:
            yield f"{path.name} is broken"
    if any(out.glob(UNFINISHED + "*")):
        number = stop_ways.FRAMES
        code = stop_ways.render(blend, out, "-f", number).wait(stop_ways.PATIENCE)
        if code or not (out / f"frame_{number:04}.exr").exists():
            yield f"the next render ends with {code}"
        for path in out.glob(UNFINISHED + "*"):
            if not is_whole(path):  # such a one may hold somebody's frame, and stays
                yield f"the next render leaves {path.name}"


def run(way, blend, out, later, row):
    """One stopped render; yields what is wrong."""
    stopped, right = stop_ways.WAYS[way]
    out.mkdir()
    code = stopped(blend, out, later)
    if code != right:
        yield f"exit code {code} instead of {right}"
    yield from (f"left: {line}" for line in processes_of(out))
    yield from look(blend, out, row)
    for path in out.iterdir():
        path.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ways", nargs="+", choices=stop_ways.WAYS, default=stop_ways.ways_here())
    options = parser.parse_args()
    chance = random.Random(options.seed)
    kinds = ("runs", "whole files", "unfinished files", "wrong")
    rows = {way: Counter(dict.fromkeys(kinds, 0)) for way in options.ways}
    with tempfile.TemporaryDirectory() as folder:
        blend = Path(folder) / "scene.blend"
        words = ["--python", TESTS / "moving_square.py", "--", blend, 320, 32, stop_ways.FRAMES]
        if stop_ways.start([*stop_ways.BLENDER, "-b", "--python-exit-code", 1, *words]).wait():
            sys.exit("the scene cannot be made")
        for number in range(options.runs):
            way, later = options.ways[number % len(options.ways)], chance.uniform(0.0, 1.5)
            row = rows[way]
            row["runs"] += 1
            for wrong in run(way, blend, Path(folder) / str(number), later, row):
                row["wrong"] += 1
                print(f"{way}, {later:.3f} s after the first frame: {wrong}", flush=True)
    print(f"| way | {' | '.join(kinds)} |\n|{'---|' * (1 + len(kinds))}")
    for way, row in rows.items():
        print(f"| {way} | {' | '.join(str(row[kind]) for kind in kinds)} |")
    measure.save("cancels", [{"way": way, **row} for way, row in rows.items()])
    sys.exit(any(row["wrong"] for row in rows.values()))


if __name__ == "__main__":
    main()
