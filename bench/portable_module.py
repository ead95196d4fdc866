# SPDX-License-Identifier: GPL-3.0-or-later
"""The module of the portable zip beside the one that g++ builds here: the same pictures, how much slower.

    ./dev package && ./dev bench portable_module [--runs 3] [--scenes NAME...] [--python FILE]

Debian's Blender (or the one that is a module of the Python FILE) renders each scene with this tree's add-on and module, and with
the add-on of the legacy zip in an empty configuration, in turns, one thread each, every time in a process of its own.  Prints the part
of the numbers that are equal, the largest difference, the RMSE and the ratio of medians of processor seconds (whole frames, export
included); writes bench/results/portable_module.json.  Fails where a picture is beyond the bounds of docs/decisions/portable.md.
"""

import argparse
import compileall
import contextlib
import os
import statistics
import tempfile
import zipfile
from pathlib import Path

import frames
import measure
import numpy as np
import pictures

ROOT = Path(__file__).resolve().parent.parent
# What each rests on: hiding alone, a lens, rays of Embree, opacity, ribbons, programs of noise, lights, and textures of
# OpenImageIO with all the rest.
SCENES = {
    "spheres": ("scenes", 16),
    "lens": ("scenes", 16),
    "lit": ("scenes", 16),
    "feathers": ("scenes", 16),
    "grass": ("scenes", 16),
    "wall": ("lit_scenes", 16),
    "fur": ("lit_scenes", 16),
    "lamps_100": ("lamp_scenes", 16),
    "demo": ("demo", 16),
}
# What a picture may differ by: one number, and the RMSE.
LARGEST, RMSE = 2e-3, 2e-5


@contextlib.contextmanager
def installed(archive):
    """A folder with the add-on of the zip, compiled as Python leaves it after its first use, and the tree's: it took a tenth of
    a second of each frame else."""
    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(archive) as opened:
            opened.extractall(Path(folder) / "scripts/addons")
        compileall.compile_dir(folder, quiet=1)
        yield folder


@contextlib.contextmanager
def alone(folder):
    """Blender finds the add-on in the folder and nothing else."""
    kept = dict(os.environ)
    os.environ["BLENDER_USER_SCRIPTS"] = f"{folder}/scripts"
    os.environ["BLENDER_USER_CONFIG"] = f"{folder}/config"
    os.environ.pop("PYTHONPATH")  # the tree's module
    try:
        yield
    finally:
        os.environ |= kept


def turn(job, python):
    """(picture, processor seconds) of the second frame of a process of its own.  The first has what a module touches for the first
    time: of ours four hundredths of a second, of g++'s libraries a quarter, but when it is imported."""
    with tempfile.TemporaryDirectory() as folder:
        ((_, run),) = frames.run_job("render_frames.py", job, folder, python)
        return pictures.load(Path(folder) / "0.exr"), run[1]


def measured(name, addon, runs, python):
    with tempfile.TemporaryDirectory() as folder:
        return compared(name, addon, runs, python, f"{folder}/scene.blend")


def compared(name, addon, runs, python, blend):
    module, samples = SCENES[name]
    setting = {"engine": "GRANITA", "samples": samples}
    job = {"module": module, "scene": name, "runs": 2, "settings": [setting], "blend": blend}
    seconds = {"tree": [], "zip": []}
    for _ in range(runs):
        tree, taken = turn(job, python)
        seconds["tree"].append(taken)
        with alone(addon):
            portable, taken = turn(job, python)
        seconds["zip"].append(taken)
    difference = np.abs(tree.astype(float) - portable)
    medians = {place: statistics.median(taken) for place, taken in seconds.items()}
    return {
        "scene": name,
        "equal": float(np.mean(difference == 0)),
        "beyond": int(np.sum(difference.max(-1) > LARGEST)),
        "largest": float(difference.max()),
        "rmse": float(np.sqrt(np.mean(difference**2))),
        **medians,
        "ratio": medians["zip"] / medians["tree"],
    }


def tell(row):
    print(
        f"| {row['scene']} | {row['equal']:.2%} | {row['largest']:.1e} | {row['beyond']} | {row['rmse']:.1e} "
        f"| {row['tree']:.2f} | {row['zip']:.2f} | {row['ratio']:.3f} |",
        flush=True,
    )
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--python", help="one that has Blender as a module")
    options = parser.parse_args()
    version = (ROOT / "VERSION").read_text().strip()
    archive = ROOT / f"dist/granita-{version}-linux-x64-legacy.zip"
    if not archive.is_file():
        print(f"There is no {archive}: not measured (./dev package)")
        return
    print("| scene | equal | largest | pixels beyond | RMSE | g++, s | zip, s | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    with installed(archive) as addon:
        rows = [
            tell(measured(name, addon, options.runs, options.python)) for name in options.scenes
        ]
    measure.save("portable_module", rows)
    if apart := [row["scene"] for row in rows if row["largest"] > LARGEST or row["rmse"] > RMSE]:
        raise SystemExit(f"Pictures beyond the bounds: {', '.join(apart)}")


if __name__ == "__main__":
    main()
