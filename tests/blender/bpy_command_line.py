# SPDX-License-Identifier: GPL-3.0-or-later
"""`blender -b FILE -E GRANITA -o OUT --python-expr CODE -s FIRST -e LAST -a -- OPTIONS` where Blender
is the module `bpy`, which has no command line of its own:

    python bpy_command_line.py FILE OUT CODE FIRST LAST -- OPTIONS

An exception ends Python with 1, as a failed render ends Blender with 1.
"""

import atexit
import os
import sys

import bpy

sys.path.insert(0, os.path.join(os.environ["BLENDER_USER_SCRIPTS"], "addons"))
import addon_utils  # noqa: E402

PREPARATION = "preparation"  # the module that CODE believes to be


def release_engine():
    """What is still registered, or hooked in, when Python ends may hang or crash `bpy`."""
    for name in dir(bpy.app.handlers):
        hooks = getattr(bpy.app.handlers, name)
        if isinstance(hooks, list):
            hooks[:] = [hook for hook in hooks if hook.__module__ != PREPARATION]
    for scene in bpy.data.scenes:
        scene.render.engine = "CYCLES"
    addon_utils.disable("granita")


def main(file, out, code, first, last):
    addon_utils.enable("granita", default_set=True)
    atexit.register(release_engine)
    bpy.ops.wm.open_mainfile(filepath=file)
    scene = bpy.context.scene
    scene.render.engine = "GRANITA"
    scene.render.filepath = out
    exec(code, {"__name__": PREPARATION})
    scene.frame_start, scene.frame_end = int(first), int(last)
    bpy.ops.render.render(animation=True)


main(*sys.argv[1:6])
