# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames in a control group of 2 GiB, as a farm gives a task: the kernel's killer is never met.

Where this process may not make a control group (of version 2 inside one that has processes, or without root) the
tests are skipped: a limit of address space is another thing, as nothing can be given back to it.
"""

import json
import os
import re
import subprocess
from pathlib import Path

import exr
import numpy as np
import pytest
from memory_group import MemoryGroup

HERE = Path(__file__).resolve().parent
GIB = 1 << 30
DEFAULT = 1843  # MiB: nine tenths of the group's, where the command line names none


@pytest.fixture
def group():
    try:
        with MemoryGroup(2 * GIB) as made:
            yield made
            assert made.kills() == 0
    except OSError as error:
        pytest.skip(f"no control group can be made here: {error}")


@pytest.fixture
def memory_scene(blender, tmp_path):
    """memory_scene(kind) -> path of a file of memory_scenes.py."""

    def make(kind):
        path = tmp_path / f"{kind}.blend"
        words = [blender, "-b", "--python-exit-code", "1", "--python", HERE / "memory_scenes.py"]
        subprocess.run([*words, "--", path, kind], check=True, stdin=subprocess.DEVNULL)
        return path

    return make


@pytest.fixture
def render(blender, group, tmp_path):
    """render(blend, name, option...) -> (exit code, all that was said, paths of the frame and of its statistics)"""

    def run(blend, name, *options):
        out, stats = tmp_path / name, tmp_path / f"{name}.json"
        out.mkdir()
        words = [blender, "-b", blend, "-E", "GRANITA", "-o", out / "frame_####", "-f", "1", "--"]
        done = group.run(
            [*words, "--granita-stats", stats, *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            text=True,
            env=os.environ | {"GRANITA_SKIP_INSTALL": "1"},
            timeout=300,
        )
        return done.returncode, done.stdout, out / "frame_0001.exr", stats

    return run


def peak(stats):
    """MiB that the process held."""
    return json.loads(stats.read_text())["peak_resident_bytes"] >> 20


def test_a_frame_that_fits_is_rendered(render, scene):
    code, said, frame, _ = render(scene, "fits")
    assert code == 0, said
    assert exr.read(frame)


def test_textures_are_given_up_within_a_limit_and_the_picture_is_the_same(render, memory_scene):
    blend = memory_scene("textures")
    limit = 400  # MiB
    code, said, free, stats = render(blend, "free")
    assert code == 0, said
    assert peak(stats) > limit + 400
    code, said, kept, stats = render(blend, "kept", "--granita-memory", str(limit))
    assert code == 0, said
    assert peak(stats) < limit + 200  # pages of mapped files are in it, which the limit leaves out
    expected = exr.read(free)
    for name, plane in exr.read(kept).items():
        np.testing.assert_array_equal(plane, expected[name])


@pytest.mark.parametrize(
    "millions, taken",
    [
        # What rays trace of them does not fit: Blender has given its own back by then.
        (7, r"\d+ MiB by Blender and the scene, \d+ MiB by what was being made"),
        # Nor does what is read of them beside Blender's own.
        (9, r"\d+ MiB are taken by Blender and the scene, \d+ MiB more are wanted"),
        # Nor does Blender's own, nearly: it is within what is kept free.
        (12, r"\d+ MiB are taken by Blender and the scene"),
    ],
    ids=["rays", "export", "Blender"],
)
def test_without_an_option_the_groups_limit_ends_a_frame_that_cannot_fit(
    render, memory_scene, millions, taken
):
    code, said, frame, _ = render(memory_scene(str(millions)), "faces")
    assert code == 1, said
    error = re.search(r"^Error: (the \w+ wants more memory .*)", said, re.MULTILINE)[1]
    assert f"wants more memory than {DEFAULT} MiB, its limit: " in error
    assert re.search(taken, error), error
    assert re.search(rf"the largest is \w+ 'Hills', {millions},000,000 faces", error), error
    assert "the limit is 90% of what the control group may hold" in error
    assert not list(frame.parent.iterdir())
