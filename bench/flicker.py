# SPDX-License-Identifier: GPL-3.0-or-later
"""How much rooms lit by what bounces flicker while a camera walks past them (walk_scene.py), beside Cycles.

    ./dev bench flicker [--scenes still metal shining] [--reference 512]

One thread each, four bounces, no motion blur.  A frame's error is its difference from Cycles' converged picture of that frame;
flicker is the RMSE of the change of that error from each frame to the next: what stands still on a wall does not count, nor
does what is wrong alike in all frames.  Cycles takes as many samples as fill `TIMES` times Granita's seconds.  The last
columns are the reference's own flicker, of the halves that it is made of, and both without it.  Writes bench/results/flicker.json.
"""

import argparse

import bounces
import frames
import numpy as np
from measure import save

FRAMES, SIZE = 24, (160, 160)
TIMES = 4
PROBE = 16  # samples that tell what one of Cycles costs
SETTINGS = ({"samples": 16, "light_samples": 16}, {"samples": 64, "light_samples": 16})


def job_of(scene, setting):
    each = [{**setting, "frame": 1 + i, "bounces": bounces.BOUNCES} for i in range(FRAMES)]
    job = {"module": "walk_scene", "scene": scene, "variant": FRAMES, "runs": 1, "size": SIZE}
    return {**job, "settings": each}


def walk(scene, setting, seed=0):
    """(pictures [frames, height, width, 3], seconds a frame)"""
    made = frames.render({**job_of(scene, setting), "seed": seed})
    return np.stack([image for image, _ in made]), float(np.mean([s for _, s in made]))


def flicker(error):
    return float(np.sqrt(np.mean(np.diff(error, axis=0) ** 2)))


def reference(scene, samples):
    """(pictures, their own flicker)"""
    half = {"engine": "CYCLES", "samples": samples // 2}
    first, second = (walk(scene, half, seed)[0] for seed in (1, 2))
    return (first + second) / 2, flicker((first - second) / 2)


def measure(scene, options):
    truth, own = reference(scene, options.reference)
    _, probe = walk(scene, {"engine": "CYCLES", "samples": PROBE})
    rows = []
    for setting in SETTINGS:
        image, seconds = walk(scene, {"engine": "GRANITA", **setting})
        samples = max(1, round(PROBE * TIMES * seconds / probe))
        beside, spent = walk(scene, {"engine": "CYCLES", "samples": samples})
        found = {"granita": flicker(image - truth), "cycles": flicker(beside - truth)}
        rows.append({"scene": scene, **setting, "seconds": seconds, **found, "reference": own})
        rows[-1].update(cycles_samples=samples, cycles_seconds=spent)
        less = [max(0.0, value**2 - own**2) ** 0.5 for value in found.values()]
        print(
            f"| {scene} | {setting['samples']} / {setting['light_samples']} | {seconds:.2f} | {found['granita']:.4f} "
            f"| {samples} | {spent:.2f} | {found['cycles']:.4f} | {own:.4f} | {less[0]:.4f} {less[1]:.4f} |",
            flush=True,
        )
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes", nargs="+", default=("still", "metal", "shining"))
    parser.add_argument("--reference", type=int, default=512)
    options = parser.parse_args()
    print(
        "| scene | samples / light samples | seconds a frame | flicker | Cycles' samples | seconds | flicker "
        "| the reference's | without it |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    save("flicker", [row for scene in options.scenes for row in measure(scene, options)])


if __name__ == "__main__":
    main()
