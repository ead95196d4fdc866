# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that are stopped at random times: under a frame's name there is a whole file or none.

    ./dev bench cancels [--runs 50] [--seed 1]

Float OpenEXR files of a small moving scene, an animation of 60 frames, stopped by SIGINT, SIGTERM or SIGKILL up to a second and a half after
its first frame.  Prints each file that is not whole; ends with 1 where there is one.
"""

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent / "tests" / "blender"
sys.path.insert(0, str(TESTS))
import exr  # noqa: E402

FRAMES = 60
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
BLENDER = ["blender", "-b", "--factory-startup", "--addons", "granita"]


def run(*words):
    streams = {
        "stdin": subprocess.DEVNULL,
        "stdout": subprocess.DEVNULL,
        "stderr": subprocess.DEVNULL,
    }
    return subprocess.Popen([*BLENDER, *map(str, words)], **streams)


def stopped(blend, out, stop, later):
    """Paths of the files that a render leaves which is stopped `later` seconds after its first frame."""
    process = run(blend, "-E", "GRANITA", "-o", out / "frame_####", "-a")
    began = time.monotonic()
    while not any(out.glob("frame_*")) and time.monotonic() - began < 60.0:
        time.sleep(0.02)
    time.sleep(later)
    process.send_signal(stop)
    process.wait(timeout=60)
    return sorted(out.iterdir())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    whole, unfinished, broken = 0, 0, []
    with tempfile.TemporaryDirectory() as folder:
        blend = Path(folder) / "scene.blend"
        scene = ["--python", TESTS / "moving_square.py", "--", blend, 640, 64, FRAMES]
        if run("--python-exit-code", 1, *scene).wait():
            sys.exit("the scene cannot be made")
        for number in range(options.runs):
            out = Path(folder) / str(number)
            out.mkdir()
            stop, later = chance.choice(SIGNALS), chance.uniform(0.0, 1.5)
            for path in stopped(blend, out, stop, later):
                try:
                    if path.name.startswith(".unfinished-"):  # not a frame's name
                        unfinished += 1
                    else:
                        exr.read(path)
                        whole += 1
                except Exception as error:
                    broken.append(f"{stop.name}, {later:.3f} s later: {path.name}: {error}")
                path.unlink()
    print(f"{options.runs} runs, {whole} whole files, {unfinished} under names of unfinished ones")
    print(f"{len(broken)} broken", *broken, sep="\n")
    sys.exit(bool(broken))


if __name__ == "__main__":
    main()
