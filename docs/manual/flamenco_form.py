# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the manual's picture of Granita's job type in the form of Flamenco's own add-on, in a window under Xvfb.

    blender -b --factory-startup --addons granita --python docs/manual/flamenco_form.py -- ADDON

ADDON is the folder `flamenco` of that add-on, which https://flamenco.blender.org offers.  Its panel draws
the form; that it gets the job type from this script instead of from a Manager is all that differs.  It asks
for `requests` and `urllib3`, which Debian's Blender has not: in a folder of PYTHONPATH.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from window_steps import take_steps  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
FORM = ROOT / "docs/manual/images/flamenco.png"
SIZE = "640x480"


def job_type():
    """What a Manager would say of farm/flamenco/granita.js."""
    compiler = ROOT / "tests/farm/flamenco_manager.js"
    job = json.dumps({"settings": {"frames": "1", "chunk_size": 1, "format": "PNG"}})
    said = subprocess.run(
        ["node", compiler, ROOT / "farm/flamenco/granita.js", job],
        capture_output=True,
        check=True,
    ).stdout
    found = json.loads(said)["type"]
    return {"name": "granita", "etag": "", **found}


def make(addon):
    """In background: a file by name, and the window that shows its form."""
    with tempfile.TemporaryDirectory() as folder:
        addons = Path(folder) / "scripts/addons"
        addons.mkdir(parents=True)
        (addons / "flamenco").symlink_to(Path(addon).resolve())
        (addons / "granita").symlink_to(ROOT / "addon")
        bpy.context.scene.frame_end = 120
        blend = str(Path(folder) / "shot.blend")
        bpy.ops.wm.save_as_mainfile(filepath=blend)
        width, height = SIZE.split("x")
        subprocess.run(
            ["xvfb-run", "-a", "-s", f"-screen 0 {SIZE}x24", bpy.app.binary_path]
            + ["--factory-startup", "--addons", "granita", "--window-geometry", "0", "0"]
            + [width, height, blend, "--python", __file__],
            env={
                **os.environ,
                "LIBGL_ALWAYS_SOFTWARE": "1",
                "BLENDER_USER_SCRIPTS": str(addons.parent),
                "BLENDER_USER_CONFIG": folder,
            },
            check=True,
        )


def show_form():
    """In the window; yields seconds to wait."""
    bpy.ops.preferences.addon_enable(module="flamenco")
    from flamenco import job_types
    from flamenco.manager.configuration import Configuration
    from flamenco.manager.model_utils import validate_and_convert_types
    from flamenco.manager.models import AvailableJobTypes

    bpy.context.preferences.view.show_splash = False
    types = {"job_types": [job_type()]}
    scene = bpy.context.scene
    job_types.refresh_scene_properties(
        scene,
        validate_and_convert_types(
            types, (AvailableJobTypes,), ["job_types"], True, True, Configuration()
        ),
    )
    scene.flamenco_job_type = "granita"
    scene.flamenco_job_name = "shot"
    scene.flamenco_job_settings.render_output_root = "/render"
    # The others of that tab would push it out of the picture.
    for panel in bpy.types.Panel.__subclasses__():
        if getattr(panel, "bl_context", "") == "output" and panel.__module__.startswith("bl_ui."):
            bpy.utils.unregister_class(panel)
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "PROPERTIES"
    with bpy.context.temp_override(window=window, screen=window.screen, area=area):
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    yield 1.0
    area = window.screen.areas[0]
    area.spaces.active.context = "OUTPUT"
    yield 1.0
    with bpy.context.temp_override(window=window, screen=window.screen, area=area):
        bpy.ops.screen.screenshot_area(filepath=str(FORM))
    bpy.ops.wm.quit_blender()


def main():
    if bpy.app.background:
        make(sys.argv[-1])
        return
    take_steps(show_form())


if __name__ == "__main__":
    main()
