# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene and a Blender for farms that run on this machine (`./dev test --farm`)."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TESTS = ROOT / "tests/blender"
sys.path.insert(0, str(TESTS))


@pytest.fixture(scope="session")
def blender(tmp_path_factory):
    """A program that takes Blender's arguments and has this tree's add-on."""
    program = tmp_path_factory.mktemp("bin") / "blender"
    program.write_text(f'#!/bin/sh\nexec "{ROOT}/dev" blender --factory-startup "$@"\n')
    program.chmod(0o755)
    return program


@pytest.fixture(scope="session")
def deaf_blender(blender, tmp_path_factory):
    """One that SIGTERM does not end, as Blender in a library's uninterruptible wait."""
    program = tmp_path_factory.mktemp("deaf") / "blender"
    program.write_text(f'#!/bin/sh\ntrap \'\' TERM\nexec "{blender}" "$@"\n')
    program.chmod(0o755)
    return program


def make_scene(blender, path, samples, width):
    """Three frames."""
    done = subprocess.run(
        [blender, "-b", "--python-exit-code", "1", "--python", TESTS / "moving_square.py"]
        + ["--", path, str(width), str(samples), "3"],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        env=os.environ | {"GRANITA_SKIP_INSTALL": "1"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return path


@pytest.fixture(scope="session")
def scene(blender, tmp_path_factory):
    return make_scene(blender, tmp_path_factory.mktemp("scene") / "scene.blend", 16, 160)


@pytest.fixture(scope="session")
def paced_scene(blender, tmp_path_factory):
    """A frame of some seconds."""
    return make_scene(blender, tmp_path_factory.mktemp("paced") / "paced.blend", 512, 640)


@pytest.fixture(scope="session")
def slow_scene(blender, tmp_path_factory):
    """A frame of many minutes."""
    return make_scene(blender, tmp_path_factory.mktemp("slow") / "slow.blend", 4096, 2560)


def processes_of(file):
    """Ids of the processes that were given this file."""
    found = subprocess.run(["pgrep", "-f", f"[b]lender .*{file}"], capture_output=True, text=True)
    return found.stdout.split()
