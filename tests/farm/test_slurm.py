# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames and parts under a real Slurm of one node: arrays, dependencies, time limits, preemption."""

import subprocess
import time
from pathlib import Path

import exr
import numpy as np
import pytest
from slurm_node import SlurmNode

ROOT = Path(__file__).resolve().parents[2]
SUBMIT = ROOT / "farm/slurm/submit.sh"
DONE = ("COMPLETED",)

pytestmark = pytest.mark.skipif(not SlurmNode.is_installed(), reason="no Slurm, or not root")


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    node = SlurmNode(tmp_path_factory.mktemp("slurm"))
    node.start()
    yield node
    node.stop()


@pytest.fixture
def submit(slurm, blender):
    """submit(scene, output, first, last, parts, option...) -> number of the last job."""

    def send(*arguments):
        done = slurm.run(SUBMIT, *arguments, GRANITA_BLENDER=str(blender))
        assert done.returncode == 0, done.stderr
        return done.stdout.split()[-1]

    return send


def frames_in(folder):
    return sorted(path.name for path in folder.glob("*.exr"))


def test_an_array_of_frames_and_its_parts_give_the_same(submit, slurm, scene, tmp_path):
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    job = submit(scene, whole / "frame_####", 1, 3)
    slurm.wait_until(job, DONE)
    joined = submit(scene, parts / "frame_####", 2, 3, 2)
    slurm.wait_until(joined, DONE, 180)
    assert frames_in(whole) == [f"frame_000{n}.exr" for n in (1, 2, 3)]
    assert frames_in(parts) == ["frame_0002.exr", "frame_0003.exr"]
    for name in frames_in(parts):
        expected = exr.read(whole / name)
        for channel, plane in exr.read(parts / name).items():
            np.testing.assert_array_equal(plane, expected[channel])


def test_a_missing_file_fails_once_and_says_why(submit, slurm, blender, tmp_path):
    (tmp_path / "broken.blend").write_text("no blend")
    job = submit(tmp_path / "broken.blend", tmp_path / "frame_####", 1, 1, 1)
    slurm.wait_until(job, ("FAILED",))
    assert "Restarts=0" in slurm.run("scontrol", "-o", "show", "job", job).stdout
    assert not frames_in(tmp_path)


def log_of(slurm, job):
    return (slurm.folder / f"granita-{job}_1.log").read_text()


def wait_for_samples(slurm, job, count=1):
    """Until the task renders, for the `count`-th time."""
    path = slurm.folder / f"granita-{job}_1.log"
    for _ in range(240):
        starts = path.read_text().split("Read blend:") if path.exists() else []
        if len(starts) > count and "Sample" in starts[-1]:
            return
        time.sleep(0.5)
    raise TimeoutError(path.read_text() if path.exists() else "no log")


def rendering(scene):
    found = subprocess.run(["pgrep", "-f", f"[b]lender .*{scene}"], capture_output=True, text=True)
    return found.stdout.split()


def test_preempted_frames_begin_anew(submit, slurm, slow_scene, scene, tmp_path):
    """A job of a higher partition takes the node: SIGTERM, requeue, and then the frame once more."""
    everything = f"--cpus-per-task={slurm.cpus}"
    low = submit(slow_scene, tmp_path / "low_####", 1, 1, 1, everything)
    wait_for_samples(slurm, low)
    high = submit(scene, tmp_path / "high_####", 1, 1, 1, everything, "--partition=high")
    slurm.wait_until(high, DONE)
    assert frames_in(tmp_path) == ["high_0001.exr"]
    wait_for_samples(slurm, low, 2)
    assert "Restarts=1" in slurm.run("scontrol", "-o", "show", "job", low).stdout
    slurm.run("scancel", low)
    slurm.wait_until(low, ("CANCELLED",))
    assert frames_in(tmp_path) == ["high_0001.exr"]
    assert not rendering(slow_scene)


def test_a_killed_task_is_tried_again(submit, slurm, slow_scene, tmp_path):
    job = submit(slow_scene, tmp_path / "frame_####", 1, 1)
    wait_for_samples(slurm, job)
    for process in rendering(slow_scene):
        subprocess.run(["kill", "-KILL", process])
    wait_for_samples(slurm, job, 2)
    assert "tried again" in log_of(slurm, job)
    slurm.run("scancel", job)
    slurm.wait_until(job, ("CANCELLED",))
    assert not frames_in(tmp_path)


def test_a_time_limit_leaves_no_frame(submit, slurm, slow_scene, tmp_path):
    """The least limit is a minute."""
    job = submit(slow_scene, tmp_path / "frame_####", 1, 1, 1, "--time=1")
    slurm.wait_until(job, ("TIMEOUT",), 150)
    assert not frames_in(tmp_path)
    assert not rendering(slow_scene)
