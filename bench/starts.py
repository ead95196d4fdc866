# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that are begun and stopped at random times in one process: what stays of them.

    ./dev bench starts [--runs 200] [--seed 1] [--window]

Every fifth one goes on to its end.  Threads, open files and the heap in use (mallinfo2(3)) after each; prints what they
grew by since the first tenth, writes bench/results/starts.json; ends with 1 where it is a thread, a file or more
than a KB a run.  --window: as many turns of the add-on, a frame and a 3D view in a window of Blender instead
(turns_in_window.py), written as starts_in_window.json.
"""

import argparse
import ctypes
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import measure
import numpy as np
import snapshot_scenes

import granita_core

TO_THE_END = 5
MOST_KB = 1.0  # a run


class MallInfo(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_size_t)
        for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()
    ]


def heap_bytes():
    """Of the C library: small blocks and those that are mapped."""
    info = ctypes.CDLL(None).mallinfo2
    info.restype = MallInfo
    found = info()
    return found.uordblks + found.hblkhd


def held():
    """(threads, open files, bytes of the heap)"""
    process = Path("/proc/self")
    return [
        len(list((process / "task").iterdir())),
        len(list((process / "fd").iterdir())),
        heap_bytes(),
    ]


def run(snapshot, seconds):
    """A frame that is stopped so many seconds after its begin; None: never."""
    job = granita_core.Render(granita_core.Scene(snapshot_scenes.s.packed(snapshot)))
    began = time.monotonic()
    while not job.done():
        job.take_tiles(0.002)
        if seconds is not None and time.monotonic() - began > seconds:
            job.cancel()
            seconds = None
    try:
        job.finish()
    except granita_core.Cancelled:
        return True
    return False


def stopped_frames(runs, seed):
    """(how many were stopped, what is held after each)"""
    chance = random.Random(seed)
    snapshot = snapshot_scenes.feathers(0.1, samples=8)
    began = time.monotonic()
    run(snapshot, None)
    whole = time.monotonic() - began
    stopped, curve = 0, []
    for number in range(runs):
        later = None if number % TO_THE_END == 0 else chance.uniform(0.0, whole)
        stopped += run(snapshot, later)
        curve.append(held())
    return stopped, curve


def window_turns(turns):
    """What is held after each turn of turns_in_window.py."""
    with tempfile.TemporaryDirectory() as folder:
        job, answer = Path(folder) / "job.json", Path(folder) / "answer.json"
        job.write_text(json.dumps({"turns": turns, "file": str(answer)}))
        script = Path(__file__).with_name("turns_in_window.py")
        words = ["xvfb-run", "-a", "-s", "-screen 0 640x480x24", "blender", "--factory-startup"]
        subprocess.run(
            [*words, "--python", script, "--", job],
            env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            check=True,
        )
        return json.loads(answer.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--window", action="store_true")
    options = parser.parse_args()
    row = {"runs": options.runs}
    if options.window:
        curve = window_turns(options.runs)
    else:
        row["stopped"], curve = stopped_frames(options.runs, options.seed)
    threads, files, heap = np.array(curve, float).T
    first = options.runs // 10
    slope = np.polyfit(np.arange(first, options.runs), heap[first:], 1)[0]
    row |= {
        "threads": threads[-1] - threads[first],
        "files": files[-1] - files[first],
        "heap_kb_a_run": slope / 1e3,
    }
    print("\n".join(f"{name}: {value:.3g}" for name, value in row.items()))
    measure.save("starts_in_window" if options.window else "starts", [row])
    sys.exit(bool(row["threads"] > 0 or row["files"] > 0 or row["heap_kb_a_run"] > MOST_KB))


if __name__ == "__main__":
    main()
