# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms and places lit by what bounces, seconds against error beside Cycles: bounced_scenes.py, bounced_places.py.

    ./dev bench bounces [--scenes still metal ...] [--reference 1024]

One thread each, in turns; equal filter and shutter, four bounces in both, no clamps, no Filter Glossy.  Errors are against
the mean of two of Cycles' pictures of half the reference's samples, which share none, so that the reference's own error is known; it
is printed and not deducted.  Seconds are those of the processor.  The last column is how many times longer Cycles takes
for an error as small, its own falling with the root of its samples.  Writes bench/results/bounces.json.
"""

import argparse

import frames
from measure import save

# Scene to the module that builds it.
SCENES = dict.fromkeys(("still", "metal", "mirror", "moving", "shining"), "bounced_scenes")
SCENES |= dict.fromkeys(("window", "still_life", "forest", "head"), "bounced_places")
BOUNCES = 4
CYCLES_SAMPLES = 32
SETTINGS = [
    {"engine": "GRANITA", "samples": 16, "light_samples": 4},
    {"engine": "GRANITA", "samples": 16, "light_samples": 16},
    {"engine": "GRANITA", "samples": 64, "light_samples": 16},
    {"engine": "CYCLES", "samples": CYCLES_SAMPLES},
]


def job_of(scene, settings):
    bounced = [{**setting, "bounces": BOUNCES} for setting in settings]
    return {"module": SCENES[scene], "scene": scene, "runs": 1, "settings": bounced}


def reference(scene, samples):
    # bounced_places.py is built of bounced_scenes.py.
    files = dict.fromkeys(
        (f"{SCENES[scene]}.py", "bounced_scenes.py", "lit_scenes.py", "scenes.py")
    )
    job = job_of(scene, [{"engine": "CYCLES"}])
    return frames.reference_of_halves(f"bounced-{scene}", job, samples, files)


def measure(scene, options):
    truth, own = reference(scene, options.reference)
    made = frames.render(job_of(scene, SETTINGS))
    errors = [frames.errors(image, truth) for image, _ in made]
    cycles = made[-1][1] * errors[-1]["rmse"] ** 2
    rows = []
    for setting, (image, seconds), error in zip(SETTINGS, made, errors, strict=True):
        times = cycles / (seconds * error["rmse"] ** 2)
        mean = float(image.mean() / truth.mean() - 1)
        rows.append({"scene": scene, **setting, "seconds": seconds, **error, "mean": mean})
        print(
            f"| {scene} | {setting['engine'].title()} | {setting['samples']} "
            f"| {setting.get('light_samples', '')} | {seconds:.2f} | {error['rmse']:.4f} "
            f"| {error['flip']:.3f} | {100 * mean:+.2f} % | {own:.4f} | {times:.1f} |",
            flush=True,
        )
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenes", nargs="+", default=tuple(SCENES), choices=SCENES)
    parser.add_argument("--reference", type=int, default=1024)
    options = parser.parse_args()
    print(
        "| scene | | samples | light samples | seconds | RMSE | FLIP | mean | the reference's RMSE | times |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    save("bounces", [row for scene in options.scenes for row in measure(scene, options)])


if __name__ == "__main__":
    main()
