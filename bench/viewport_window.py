# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside a Blender with a window: makes a scene, shows it in Rendered shading and edits it (viewport.py watches).

    blender -b --factory-startup --addons granita --python viewport_window.py -- JOB.json       saves job["blend"]
    blender --factory-startup --addons granita BLEND --python viewport_window.py -- JOB.json    shows it

Notes into job["log"], a line of JSON each, when (monotonic seconds) it did what.
"""

import json
import math
import sys
import time
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import lit_scenes  # noqa: E402
import scenes  # noqa: E402
from view_edits import EDITS, open_lens  # noqa: E402

JOB = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
LOG = open(JOB["log"], "a", buffering=1)


def note(**entry):
    LOG.write(json.dumps({"time": time.monotonic(), **entry}) + "\n")


def build():
    scene = {**scenes.SCENES, **lit_scenes.SCENES}[JOB["scene"]]()
    scene.render.engine = JOB["engine"]
    scene.render.threads_mode = "AUTO"
    scene.render.use_motion_blur = JOB.get("blur", True)
    scene.granita.preview_samples, scene.granita.bounces = JOB["samples"], "NONE"
    scene.cycles.preview_samples = JOB["samples"]
    scene.cycles.use_preview_adaptive_sampling = False
    scene.cycles.max_bounces = 0
    scene.eevee.taa_samples = JOB["samples"]
    bpy.ops.wm.save_as_mainfile(filepath=JOB["blend"])


def steps(scene):
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    region = next(r for r in area.regions if r.type == "WINDOW")
    space = area.spaces.active
    space.overlay.show_overlays = False
    space.show_gizmo = False
    space.show_region_header = space.show_region_toolbar = False
    space.show_region_tool_header = False
    view = space.region_3d
    view.view_perspective = "CAMERA"
    # The frame is 480 pixels wide: Blender draws it region.width * zoom^2 / 4 wide.
    view.view_camera_zoom = (2.0 * math.sqrt(480 / region.width) - math.sqrt(2.0)) * 50.0
    scene.camera.data.show_passepartout = False
    if JOB.get("lens", True):
        open_lens(scene.camera.data)
    yield 0.5
    height = window.height
    note(
        box=[region.x + 8, height - region.y - region.height + 64, region.x + region.width - 8]
        + [height - region.y - 8]
    )  # below the text
    yield 0.5
    note(edit="to rendered")
    space.shading.type = "RENDERED"
    yield JOB["rest"]
    for name in JOB["edits"]:
        note(edit=name)
        EDITS[name](scene, view, 0)
        yield JOB["rest"]
    for name in JOB["drags"]:
        note(drag=name)
        began, k = time.monotonic(), 1
        while time.monotonic() - began < 3.0:
            EDITS[name](scene, view, k)
            k += 1
            yield 1 / 60
        note(drag_end=name, edits=k - 1)
        yield JOB["rest"]
    loop = sys.modules.get("granita.viewport.loop")
    if JOB["engine"] == "GRANITA" and loop.views():
        note(counts=dict(loop.views()[0].counts))
    note(end=True)
    bpy.ops.wm.quit_blender()


todo = steps(bpy.context.scene) if not bpy.app.background else None


def step():
    try:
        return next(todo, None)
    except BaseException as error:
        note(error=repr(error))
        bpy.ops.wm.quit_blender()


if bpy.app.background:
    build()
else:
    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(step, first_interval=1.0)
