# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that are begun and stopped at random times in one process: what stays of them.

    ./dev bench starts [--runs 200] [--seed 1]

Every fifth one goes on to its end.  Threads, open files and the heap in use (mallinfo2(3)) after each; prints what they
grew by since the first tenth, writes bench/results/starts.json.
"""

import argparse
import ctypes
import random
import time
from pathlib import Path

import measure
import numpy as np
import snapshot_scenes

import granita_core

TO_THE_END = 5


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


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    snapshot = snapshot_scenes.feathers(0.1, samples=8)
    began = time.monotonic()
    run(snapshot, None)
    whole = time.monotonic() - began
    stopped, curve = 0, []
    for number in range(options.runs):
        later = None if number % TO_THE_END == 0 else chance.uniform(0.0, whole)
        stopped += run(snapshot, later)
        curve.append(held())
    threads, files, heap = np.array(curve, float).T
    first = options.runs // 10
    slope = np.polyfit(np.arange(first, options.runs), heap[first:], 1)[0]
    row = {
        "runs": options.runs,
        "stopped": stopped,
        "threads": threads[-1] - threads[first],
        "files": files[-1] - files[first],
        "heap_kb_a_run": slope / 1e3,
    }
    print("\n".join(f"{name}: {value:.3g}" for name, value in row.items()))
    measure.save("starts", [row])


if __name__ == "__main__":
    main()
