# SPDX-License-Identifier: GPL-3.0-or-later
"""Run a script under Blender as a Python module, the add-on enabled: bpy_host.py SCRIPT [ARG]...

Ends with the script's exit code.  The add-on is disabled before: Blender's leak detector prints thousands of lines for an
engine class that is still registered or still chosen by a scene.  Blender itself is not torn down: 4.2 crashes then, and 4.5
waits for ever for a thread of its own that closes files.
"""

import atexit
import os
import runpy
import sys
import traceback

import bpy  # isort: skip  (first: Blender's own modules are found through it)
import addon_utils


def release_engine() -> None:
    """Give every scene Blender's own engine back and unregister ours."""
    for scene in bpy.data.scenes:
        if scene.render.engine == "GRANITA":
            scene.render.engine = "CYCLES"
    addon_utils.disable("granita")


def run(script: str) -> int:
    """Its exit code."""
    try:
        runpy.run_path(script, run_name="__main__")
    except SystemExit as end:
        if end.code is not None and not isinstance(end.code, int):
            print(end.code, file=sys.stderr)
            return 1
        return end.code or 0
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def main() -> int:
    if len(sys.argv) < 2:
        print("usage: bpy_host.py SCRIPT [ARG]...", file=sys.stderr)
        return 1
    if addon_utils.enable("granita") is None:
        print("the add-on does not register", file=sys.stderr)
        return 1
    del sys.argv[0]
    code = run(sys.argv[0])
    release_engine()
    return code


code = main()
atexit._run_exitfuncs()
sys.stdout.flush()
sys.stderr.flush()
os._exit(code)
