# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs pytest inside a Blender, with this tree's add-on enabled; ends with pytest's exit code.

    blender -b --factory-startup --python run_in_blender.py -- [pytest arguments]
    python run_in_blender.py -- [pytest arguments]        where Blender is the module `bpy`

Without a path among the arguments all of tests/blender runs.  The native module is taken from
Python's path, else from the tree's build folder.  Where GRANITA_ADDON names an installed add-on's folder,
that and its own module take the place of the tree's.
"""

import atexit
import importlib
import importlib.util
import os
import shutil
import signal
import sys
import tempfile
import traceback
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
ADDON = Path(os.environ.get("GRANITA_ADDON", ROOT / "addon"))


def private_scripts():
    """A scripts folder that links to the add-on: for this Blender and for those it starts."""
    scripts = Path(tempfile.mkdtemp(prefix="granita-scripts-"))
    atexit.register(shutil.rmtree, scripts, ignore_errors=True)
    (scripts / "addons").mkdir()
    (scripts / "addons" / "granita").symlink_to(ADDON)
    os.environ["BLENDER_USER_SCRIPTS"] = str(scripts)
    os.environ["BLENDER_USER_CONFIG"] = str(scripts / "config")
    sys.path.insert(0, str(scripts / "addons"))


def find_native_module():
    if importlib.util.find_spec("granita_core"):
        return
    if "GRANITA_ADDON" in os.environ:
        # Its own, under its one name: a process that loaded it twice would define its types twice.
        sys.modules["granita_core"] = importlib.import_module("granita.granita_core")
        return
    for module in sorted((ROOT / "build").rglob("granita_core*.so")):
        folder = str(module.parent)
        sys.path.insert(0, folder)
        path = [folder, os.environ.get("PYTHONPATH", "")]
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, path))
        return


def heed_interrupts():
    """A shell has its background jobs ignore Ctrl-C, and so would all that they start."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def enable_addon():
    import addon_utils

    if addon_utils.enable("granita", default_set=True) is None:
        raise RuntimeError("the add-on did not register")


def leave_engine():
    """An engine class still registered, or in use, at the end of a `bpy` process may hang it."""
    import bpy

    for scene in bpy.data.scenes:
        scene.render.engine = "CYCLES"
    if hasattr(bpy.types.Scene, "granita"):
        import addon_utils

        addon_utils.disable("granita")


def main(arguments):
    import bpy  # noqa: F401  (first: Blender's own modules are found through it)

    heed_interrupts()
    private_scripts()
    enable_addon()
    find_native_module()
    import pytest

    if not any(Path(argument.split("::")[0]).exists() for argument in arguments):
        arguments = [*arguments, str(HERE)]
    try:
        return int(
            pytest.main(["--rootdir", str(ROOT), "-c", str(ROOT / "pyproject.toml"), *arguments])
        )
    finally:
        leave_engine()


if __name__ == "__main__":
    own = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    try:
        code = main(own)
    except Exception:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    import bpy

    if not bpy.app.binary_path:
        # bpy 4.2 frees its panel types after Python has ended and crashes there (SpaceType's
        # destructor, bpy_class_free), whatever the tests said: leave once Python's own part is done.
        atexit._run_exitfuncs()
        sys.stderr.flush()
        os._exit(code)
    sys.exit(code)
