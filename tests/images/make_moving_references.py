# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the references of the eight animated files with Cycles (an hour on one core), kept as 16-bit half.

    python3 tests/images/make_moving_references.py [SCENE ...] [--variants emission lit]

Debian's Blender 3.4, 4096 samples a pixel (alien, lit: 1024).  references/moving_SCENE.npz holds `emission` and `lit`, f16 [135,240,3]
linear, top row first, and `blurred`, bool [135,240]: the pixels that blur changes by more than .01.  Half's relative
error of 5e-4 is far below the tolerances.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import pictures  # noqa: E402

STILL_SAMPLES = 512
SCENES = ("bend", "camera", "snake", "instances", "particles", "morph", "alien", "hair")


def render(name, variant, samples, folder):
    out = Path(folder) / f"{variant}.exr"
    command = ["blender", "-b", "--factory-startup", "--python-exit-code", "1"]
    command += ["--python", str(HERE / "moving_files.py"), "--"]
    command += [name, variant, "CYCLES", str(out), str(samples)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    print(
        name,
        variant,
        *[line for line in done.stdout.splitlines() if line.startswith("seconds")],
        flush=True,
    )
    return pictures.load(out)


def keep(name, images):
    """Adds what was rendered to the scene's file."""
    path = HERE / "references" / f"moving_{name}.npz"
    kept = dict(np.load(path)) if path.exists() else {}
    if "still" in images:
        kept["blurred"] = np.abs(images["emission"] - images.pop("still")).max(-1) > 0.01
    kept.update({variant: image.astype(np.float16) for variant, image in images.items()})
    np.savez_compressed(path, **kept)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument(
        "--variants", nargs="+", choices=("emission", "lit"), default=("emission", "lit")
    )
    parser.add_argument("--samples", type=int, default=4096)
    options = parser.parse_args()
    for variant in options.variants:
        for name in options.scenes:
            wanted = ("emission", "still") if variant == "emission" else ("lit",)
            counts = {v: STILL_SAMPLES if v == "still" else options.samples for v in wanted}
            with tempfile.TemporaryDirectory() as folder:
                keep(name, {v: render(name, v, n, folder) for v, n in counts.items()})


if __name__ == "__main__":
    main()
