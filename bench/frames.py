# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames out of Blender and how wrong they are, for the benches."""

import hashlib
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests" / "images"))
import pictures  # noqa: E402
from figure_files import write_png  # noqa: E402

CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "granita" / "bench"
SEEDS = (1, 2, 3, 4)  # of the reference; what is measured has 0


def run_in_blender(script, argument, python=None):
    """Runs a script of this folder inside Blender, or inside a Python that has Blender as a module."""
    if python is None:
        command = ["blender", "-b", "--factory-startup", "--addons", "granita"]
        command += ["--python-exit-code", "1", "--python", str(HERE / script)]
    else:
        command = [python, str(HERE.parent / "tools" / "bpy_host.py"), str(HERE / script)]
    done = subprocess.run([*command, "--", str(argument)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stdout[-3000:] + done.stderr[-3000:])


def run_job(script, job, folder, python=None):
    """Runs a script that is told its job as JSON, in a folder of its own, and answers in the file job["file"] there."""
    file, answer = Path(folder) / "job.json", Path(folder) / "answer.json"
    file.write_text(json.dumps({**job, "folder": str(folder), "file": str(answer)}))
    run_in_blender(script, file, python)
    return json.loads(answer.read_text())


def ask(script, job, python=None):
    """The answer alone."""
    with tempfile.TemporaryDirectory() as folder:
        return run_job(script, job, folder, python)


def render(job, clock="processor", python=None):
    """Runs a job (render_frames.py), in a Blender or a Python that has it; returns for each setting (image, median seconds)."""
    with tempfile.TemporaryDirectory() as folder:
        seconds = run_job("render_frames.py", job, folder, python)
        column = {"wall": 0, "processor": 1}[clock]
        return [
            (
                pictures.load(Path(folder) / f"{i}.exr"),
                statistics.median(run[column] for run in runs),
            )
            for i, runs in enumerate(seconds)
        ]


def fingerprint(scene, all_scenes):
    """Of the part of scenes.py that a scene is built by: all but the other scenes' builders."""
    parts = re.split(r"^def (\w+)", (HERE / "scenes.py").read_text(), flags=re.M)
    kept = [
        body
        for name, body in zip(["", *parts[1::2]], parts[::2])
        if name == scene or name not in all_scenes
    ]
    return hashlib.sha256("".join(kept).encode()).hexdigest()[:12]


def reference(scene, samples, all_scenes):
    """(Cycles' converged picture of a scene of scenes.py, the RMSE that it has itself), kept in the cache until its builder
    changes.

    The mean of four pictures that share no sample, nor any with what is measured: from their differences its error is
    known.
    """

    def parts():
        job = {"module": "scenes", "scene": scene, "runs": 1}
        job["settings"] = [{"engine": "CYCLES", "samples": samples // len(SEEDS)}]
        return [render({**job, "seed": seed})[0][0] for seed in SEEDS]

    return kept_reference(f"{scene}-{samples}-{fingerprint(scene, all_scenes)}", parts)


def still_reference(scene, samples, all_scenes, stills=32):
    """The same as the mean of Cycles' pictures without blur, spread over the shutter: each of the four parts has
    `stills` times of its own."""

    def parts():
        for part, seed in enumerate(SEEDS):
            times = [(i + (part + 0.5) / len(SEEDS)) / stills for i in range(stills)]
            each = {"engine": "CYCLES", "samples": samples // (len(SEEDS) * stills)}
            job = {"module": "scenes", "scene": scene, "runs": 1, "seed": seed}
            job["settings"] = [{**each, "at": at} for at in times]
            yield np.mean([image for image, _ in render(job)], axis=0)

    name = f"{scene}-stills{stills}-{samples}-{fingerprint(scene, all_scenes)}"
    return kept_reference(name, parts)


def reference_of_halves(name, job, samples, files, python=None):
    """The same as the mean of two pictures of half the samples, kept as that until `files` of this folder change.

    `job` (render_frames.py) has one setting, without samples."""
    digest = hashlib.sha256("".join((HERE / file).read_text() for file in files).encode())

    def parts():
        halves = [{**setting, "samples": samples // 2} for setting in job["settings"]]
        for seed in (1, 2):
            yield render({**job, "settings": halves, "seed": seed}, python=python)[0][0]

    return kept_reference(f"{name}-{samples}-{digest.hexdigest()[:12]}", parts)


def kept_reference(name, parts):
    """mean_and_error() of what `parts` renders where the cache has nothing of that name."""
    file = CACHE / f"{name}.npy"
    if not file.exists():
        CACHE.mkdir(parents=True, exist_ok=True)
        np.save(file, list(parts()))
    return mean_and_error(np.load(file))


def mean_and_error(parts):
    """(mean of independent pictures, the RMSE that it has itself)"""
    return parts.mean(axis=0), float(np.sqrt(parts.var(axis=0, ddof=1).mean() / len(parts)))


def save_png(path, linear):
    """8 bits a channel, as a screen shows it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_png(path, (pictures.srgb(linear) * 255 + 0.5).astype(np.uint8))


def errors(image, truth):
    """{rmse, percentile (99.9, of the largest channel), flip (mean, 0 to 1)}"""
    difference = np.abs(image - truth)
    return {
        "rmse": float(np.sqrt(np.mean(difference**2))),
        "percentile": float(np.percentile(difference.max(-1), 99.9)),
        "flip": float(pictures.flip(image, truth)[1]),
    }


def seconds_to(target, points):
    """(seconds until an error, mark) of [(seconds, error)] by log-log interpolation.

    The mark is "<" where the cheapest frame is good enough already, "~" where the last two frames were extended, and
    None stands for seconds where those no longer improve.
    """
    points = sorted(points)
    if points[0][1] <= target:
        return points[0][0], "<"
    for (s0, e0), (s1, e1) in zip(points, points[1:], strict=False):
        if e1 <= target:
            return s0 * (s1 / s0) ** (math.log(target / e0) / math.log(e1 / e0)), ""
    if len(points) < 2:
        return None, ""
    (s0, e0), (s1, e1) = points[-2:]
    slope = math.log(e1 / e0) / math.log(s1 / s0)
    if slope > -0.2:
        return None, ""
    return s1 * (target / e1) ** (1 / slope), "~"
