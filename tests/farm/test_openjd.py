# SPDX-License-Identifier: GPL-3.0-or-later
"""The Open Job Description templates under the standard's own runner."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import exr
import numpy as np
import pytest
from conftest import processes_of

ROOT = Path(__file__).resolve().parents[2]
OPENJD = Path(sys.executable).with_name("openjd")
FRAMES, PARTS = (ROOT / f"farm/openjd/granita_{kind}/template.yaml" for kind in ("frames", "parts"))


def command(template, *arguments, **parameters):
    words = [str(OPENJD), "run", str(template), *arguments]
    for name, value in parameters.items():
        words += ["-p", f"{name}={value}"]
    return words


def run(*arguments, **parameters):
    return subprocess.run(
        command(*arguments, **parameters),
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=300,
    )


@pytest.mark.parametrize("template", [FRAMES, PARTS], ids=lambda path: path.parent.name)
def test_templates_are_valid(template):
    done = subprocess.run([OPENJD, "check", template], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_parts_join_to_the_frames(blender, scene, tmp_path):
    common = {"SceneFile": scene, "Blender": blender, "Frames": "1,3"}
    whole = run(FRAMES, **common, OutputFolder=tmp_path / "whole")
    assert whole.returncode == 0, whole.stdout + whole.stderr
    assert "openjd_progress: 100.0" in whole.stdout
    assert "openjd_status: frame 3" in whole.stdout
    parts = run(
        *(PARTS, "--step", "Merge", "--run-dependencies"),
        **common,
        OutputFolder=tmp_path / "parts",
        Parts=2,
    )
    assert parts.returncode == 0, parts.stdout + parts.stderr
    for frame in ("frame_0001.exr", "frame_0003.exr"):
        expected = exr.read(tmp_path / "whole" / frame)
        for name, plane in exr.read(tmp_path / "parts" / frame).items():
            np.testing.assert_array_equal(plane, expected[name])


def test_a_failure_is_the_tasks_and_says_why(blender, scene, tmp_path):
    done = run(
        *(PARTS, "--step", "Merge"),
        **{"SceneFile": scene, "Blender": blender, "OutputFolder": tmp_path, "Parts": 2},
    )
    assert done.returncode != 0
    assert "openjd_fail: a part is missing" in done.stdout + done.stderr
    assert not (tmp_path / "frame_0001.exr").exists()


def progress_by_task(said):
    """What each task said of its progress, in percent."""
    tasks = said.split("Phase: Running action")[1:]
    return [[float(p) for p in re.findall(r"openjd_progress: ([\d.]+)", task)] for task in tasks]


def test_progress_of_parts_and_merges_grows_to_the_end(blender, paced_scene, tmp_path):
    done = run(
        *(PARTS, "--step", "Merge", "--run-dependencies"),
        **{"SceneFile": paced_scene, "Blender": blender, "OutputFolder": tmp_path, "Parts": 2},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    tasks = progress_by_task(done.stdout)
    assert len(tasks) == 3
    for progress in tasks:
        assert progress[0] < progress[-1] == 100.0
        assert progress == sorted(progress)


def cancel_in_mid_frame(template, **parameters):
    """What the runner said, which is interrupted once a frame is being rendered; it has ended within half a minute."""
    process = subprocess.Popen(
        command(template, **parameters),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    for line in process.stdout:
        if "openjd_progress: " in line and "progress: 0.0" not in line:
            break
    began = time.monotonic()
    os.kill(process.pid, signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert process.returncode != 0, said
    assert time.monotonic() - began < 30
    return said


def test_a_cancelled_task_leaves_no_frame_and_no_process(blender, slow_scene, tmp_path):
    cancel_in_mid_frame(FRAMES, SceneFile=slow_scene, Blender=blender, OutputFolder=tmp_path)
    assert not list(tmp_path.iterdir())
    assert not processes_of(slow_scene)


def test_what_outlives_the_notice_is_killed_and_leaves_no_frame(deaf_blender, slow_scene, tmp_path):
    template, out = tmp_path / "hasty.yaml", tmp_path / "render"
    text = FRAMES.read_text()
    assert "notifyPeriodInSeconds: 30" in text
    template.write_text(text.replace("notifyPeriodInSeconds: 30", "notifyPeriodInSeconds: 2"))
    out.mkdir()
    said = cancel_in_mid_frame(
        template, SceneFile=slow_scene, Blender=deaf_blender, OutputFolder=out
    )
    assert "exited with code: -9" in said
    assert not list(out.iterdir())
    assert not processes_of(slow_scene)
