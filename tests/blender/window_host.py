# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a script in a Blender with a window, of the kind that runs the test, under Xvfb."""

import json
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


# `steps` of the watching script, from a timer: each of what it yields is waited for.
_LOOP = """
todo = steps()
def step():
    try:
        return next(todo)
    except StopIteration:
        pass
    except BaseException as error:
        found["error"] = repr(error)
    json.dump(found, open(OUT + ".json", "w"))
    bpy.ops.wm.quit_blender()
bpy.app.timers.register(step, first_interval=1.0)
"""


def watch(script, folder, blend=None):
    """(what the script found, all that Blender said); Blender has ended well.

    Args:
        script: text of Python in which bpy, json and the dictionary `found` are known, and OUT, a path to which
            endings may be added.  Defines the generator `steps`, which yields seconds to wait.
        folder: for files.
        blend: as of run().
    """
    out, file = folder / "watched", folder / "watch.py"
    file.write_text(f"import bpy, json\nOUT = {str(out)!r}\nfound = {{}}\n{script}\n{_LOOP}")
    code, said = run(file, blend=blend)
    result = folder / "watched.json"
    assert code == 0 and "Traceback" not in said and result.exists(), said
    return json.loads(result.read_text()), said
