# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a file in a Blender of its own, of the kind that runs the test, as a farm would."""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import bpy

HERE = Path(__file__).parent
# What `prepare` code ends with where it is itself wrong.
BROKEN_TEST = 77


@dataclass
class Outcome:
    code: int
    output: str
    files: list  # paths of what was saved, sorted


def command(blend, out, prepare="", first=1, last=1, options=(), alone=False):
    """The command line: opens `blend`, runs the Python text `prepare`, renders frames to `out`; `alone`: the first one
    by -f, in Blender's own program."""
    if bpy.app.binary_path:
        host = [bpy.app.binary_path, "-b", "--factory-startup", "--addons", "granita", str(blend)]
        host += ["-E", "GRANITA", "-o", str(out), "--python-exit-code", str(BROKEN_TEST)]
        host += ["--python-expr", prepare or "pass"]
        host += ["-f", str(first)] if alone else ["-s", str(first), "-e", str(last), "-a"]
    else:
        host = [sys.executable, str(HERE / "bpy_command_line.py"), str(blend), str(out)]
        host += [prepare, str(first), str(last)]
    return [*host, "--", *options]


def environment(changes=None):
    return {**os.environ, "PYTHONUNBUFFERED": "1", **(changes or {})}


def run(
    blend,
    folder,
    prepare="",
    first=1,
    last=1,
    options=(),
    env=None,
    timeout=120,
    alone=False,
    prefix=(),
):
    """Renders into `folder`; returns the Outcome.  `prefix`: words of a program that runs the command."""
    Path(folder).mkdir(exist_ok=True)
    words = command(blend, Path(folder) / "frame_####", prepare, first, last, options, alone)
    process = subprocess.run(
        [*prefix, *words],
        env=environment(env),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        text=True,
        errors="replace",
        timeout=timeout,
    )
    assert process.returncode != BROKEN_TEST, process.stdout
    return Outcome(process.returncode, process.stdout, sorted(Path(folder).iterdir()))
