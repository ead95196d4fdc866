# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames and parts under a real Slurm of one node: arrays, dependencies, time limits, preemption."""

import os
import shutil
import signal
import time
from pathlib import Path

import exr
import numpy as np
import pytest
from conftest import processes_of
from slurm_node import SlurmNode

ROOT = Path(__file__).resolve().parents[2]
SUBMIT = ROOT / "farm/slurm/submit.sh"
DONE = ("COMPLETED",)


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    node = SlurmNode(tmp_path_factory.mktemp("slurm"))
    node.start()
    yield node
    node.stop()


@pytest.fixture
def submit(slurm, blender):
    """submit(scene, output, first, last, parts, option..., program=blender) -> number of the last job."""

    def send(*arguments, program=blender):
        done = slurm.run(SUBMIT, *arguments, GRANITA_BLENDER=str(program))
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
    assert restarts(slurm, job) == {0}
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


@pytest.mark.parametrize("lacking", ["Slurm", "root"])
def test_without_slurm_or_root_these_tests_fail(lacking, tmp_path, monkeypatch):
    if lacking == "Slurm":
        monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(os, "geteuid", lambda: 0 if lacking == "Slurm" else 1000)
    with pytest.raises(RuntimeError, match=lacking):
        SlurmNode(tmp_path).start()


def restarts(slurm, job):
    shown = slurm.run("scontrol", "-o", "show", "job", job).stdout.split()
    return {int(word.partition("=")[2]) for word in shown if word.startswith("Restarts=")}


def test_preempted_frames_begin_anew(submit, slurm, slow_scene, scene, tmp_path):
    """A job of a higher partition takes the node: SIGTERM, requeue, and then the frame once more."""
    everything = f"--cpus-per-task={slurm.cpus}"
    low = submit(slow_scene, tmp_path / "low_####", 1, 1, 1, everything)
    wait_for_samples(slurm, low)
    high = submit(scene, tmp_path / "high_####", 1, 1, 1, everything, "--partition=high")
    slurm.wait_until(high, DONE)
    assert frames_in(tmp_path) == ["high_0001.exr"]
    wait_for_samples(slurm, low, 2)
    assert restarts(slurm, low) == {1}
    slurm.run("scancel", low)
    slurm.wait_until(low, ("CANCELLED",))
    assert frames_in(tmp_path) == ["high_0001.exr"]
    assert not processes_of(slow_scene)


def test_what_outlives_the_grace_time_is_killed_and_the_next_try_gives_the_frame(
    submit, slurm, deaf_blender, slow_scene, scene, tmp_path
):
    everything, shot = f"--cpus-per-task={slurm.cpus}", tmp_path / "shot.blend"
    shutil.copy(slow_scene, shot)
    low = submit(shot, tmp_path / "low_####", 1, 1, 1, everything, program=deaf_blender)
    wait_for_samples(slurm, low)
    high = submit(scene, tmp_path / "high_####", 1, 1, 1, everything, "--partition=high")
    shutil.copy(scene, shot)
    slurm.wait_until(high, DONE)
    assert frames_in(tmp_path) == ["high_0001.exr"]
    slurm.wait_until(low, DONE, 180)
    assert restarts(slurm, low) == {1}
    np.testing.assert_equal(
        exr.read(tmp_path / "low_0001.exr"), exr.read(tmp_path / "high_0001.exr")
    )
    assert not list(tmp_path.glob(".unfinished-*"))


def test_what_dies_each_time_is_tried_three_times_in_all(submit, slurm, scene, tmp_path):
    program, tries = tmp_path / "blender", tmp_path / "tries"
    program.write_text(f'#!/bin/sh\necho >>"{tries}"\nkill -KILL $$\n')
    program.chmod(0o755)
    job = submit(scene, tmp_path / "frame_####", 1, 1, program=program)
    slurm.wait_until(job, ("FAILED",), 180)
    assert restarts(slurm, job) == {2}
    assert len(tries.read_text().splitlines()) == 3


def test_a_killed_task_is_tried_again(submit, slurm, slow_scene, tmp_path):
    job = submit(slow_scene, tmp_path / "frame_####", 1, 1)
    wait_for_samples(slurm, job)
    for process in processes_of(slow_scene):
        os.kill(int(process), signal.SIGKILL)
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
    assert not processes_of(slow_scene)
