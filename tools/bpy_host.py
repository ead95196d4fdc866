# SPDX-License-Identifier: GPL-3.0-or-later
"""Run a script under Blender as a Python module, the add-on enabled: bpy_host.py SCRIPT [ARG]...

Blender's leak detector runs when the module is torn down; an engine class that is still registered
or still chosen by a scene then prints thousands of lines and may hang, so both are undone before.
"""

import atexit
import runpy
import sys

import bpy  # isort: skip  (first: Blender's own modules are found through it)
import addon_utils


def release_engine() -> None:
    """Give every scene Blender's own engine back and unregister ours."""
    for scene in bpy.data.scenes:
        if scene.render.engine == "GRANITA":
            scene.render.engine = "CYCLES"
    addon_utils.disable("granita")


def main() -> None:
    if len(sys.argv) < 2:
        sys.exit("usage: bpy_host.py SCRIPT [ARG]...")
    if addon_utils.enable("granita") is None:
        sys.exit("the add-on does not register")
    atexit.register(release_engine)
    del sys.argv[0]
    runpy.run_path(sys.argv[0], run_name="__main__")


main()
