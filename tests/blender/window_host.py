# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a script in a Blender with a window, of the kind that runs the test, under Xvfb."""

import os
import shutil
import subprocess

import bpy
import pytest

needed = pytest.mark.skipif(
    not bpy.app.binary_path or shutil.which("xvfb-run") is None,
    reason="needs a Blender with windows, and xvfb-run",
)


def run(script, *arguments, blend=None, size="800x600", timeout=150):
    """(exit code, all that it said) of a Blender that the script has to quit.

    Args:
        script: path of a Python file.
        arguments: the script's own, behind `--`.
        blend: the file that the window shows; None: Blender's own scene.
        size: of the screen, pixels.
    """
    words = [bpy.app.binary_path, "--factory-startup", "--addons", "granita"]
    words += [str(blend)] if blend else []
    words += ["--python", str(script), "--", *map(str, arguments)]
    done = subprocess.run(
        ["xvfb-run", "-a", "-s", f"-screen 0 {size}x24", *words],
        env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=timeout,
    )
    return done.returncode, done.stdout
