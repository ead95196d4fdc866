# SPDX-License-Identifier: GPL-3.0-or-later
"""Half files of frames that are swept, and all that are not: another's that may still be written first of all."""

import os
import subprocess
import sys
import time

import pytest

from addon import leftover_files

DAYS = 24 * 3600.0
NAME = "frame_0001.png"
# Of a PNG the beginning.
HALF = b"\x89PNG\r\n\x1a\n" + bytes(100)
WHOLE = HALF + b"IEND\xae\x42\x60\x82"


@pytest.fixture(scope="module")
def ended():
    """The number of a process that is gone."""
    process = subprocess.Popen([sys.executable, "-c", "pass"])
    process.wait()
    return process.pid


def of(process):
    """The name that this machine's process would give."""
    before, _, after = leftover_files.PREFIX.rpartition(f"-{os.getpid()}-")
    return f"{before}-{process}-{after}{NAME}"


def left(folder, name, content=HALF, age=0.0):
    path = folder / name
    path.write_bytes(content)
    os.utime(path, (time.time() - age,) * 2)
    return path


def is_swept(path):
    swept = leftover_files.sweep(path.parent)
    assert swept == ([] if path.exists() else [str(path)])
    return bool(swept)


def test_what_an_ended_process_left_is_removed(tmp_path, ended):
    assert is_swept(left(tmp_path, of(ended)))


@pytest.mark.parametrize("process", [os.getpid(), 1, 10**30])
def test_what_a_process_may_still_write_stays_for_a_day(tmp_path, process):
    assert not is_swept(left(tmp_path, of(process), age=0.9 * DAYS))
    assert is_swept(left(tmp_path, of(process), age=1.1 * DAYS))


@pytest.mark.parametrize("part", ["machine", "start", "neither is told"])
def test_of_what_ran_elsewhere_nothing_is_known_for_a_day(tmp_path, ended, monkeypatch, part):
    node, start = leftover_files._OURS.removeprefix(".unfinished-")[:-1].rsplit("-", 1)
    if part == "machine":
        node += "-2"
    elif part == "start":  # or another container of that name
        start = "0" * 8
    else:
        start = "unknown"
        monkeypatch.setattr(leftover_files, "_PROCESSES", "")
        monkeypatch.setattr(leftover_files, "_OURS", f".unfinished-{node}-{start}-")
    name = f".unfinished-{node}-{start}-{ended}-abcdef-{NAME}"
    assert not is_swept(left(tmp_path, name, age=0.9 * DAYS))
    assert is_swept(left(tmp_path, name, age=1.1 * DAYS))


def test_a_whole_frame_stays(tmp_path, ended):
    """It could not take its name: whose it is was told where it lies."""
    assert not is_swept(left(tmp_path, of(ended), WHOLE, age=9 * DAYS))


@pytest.mark.parametrize(
    "name", [NAME, ".unfinished-", ".unfinished-frame-1-2.png", ".unfinished-mine.png"]
)
def test_other_files_stay(tmp_path, name):
    assert not is_swept(left(tmp_path, name, age=9 * DAYS))


def test_links_and_folders_stay(tmp_path, ended):
    link = tmp_path / of(ended)
    link.symlink_to(left(tmp_path, "elsewhere", age=9 * DAYS))
    assert not is_swept(link)
    link.unlink()
    link.mkdir()
    assert not is_swept(link)


def test_a_folder_that_is_not_there_has_none(tmp_path):
    assert leftover_files.sweep(tmp_path / "none") == []
