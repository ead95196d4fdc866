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

JOB = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
LOG = open(JOB["log"], "a", buffering=1)


def note(**entry):
    LOG.write(json.dumps({"time": time.monotonic(), **entry}) + "\n")


def build():
    scene = {**scenes.SCENES, **lit_scenes.SCENES}[JOB["scene"]]()
    scene.render.engine = JOB["engine"]
    scene.render.threads_mode = "AUTO"
    scene.render.use_motion_blur = JOB.get("blur", True)
    scene.granita.preview_samples = JOB["samples"]
    scene.cycles.preview_samples = JOB["samples"]
    scene.cycles.use_preview_adaptive_sampling = False
    scene.cycles.max_bounces = 0
    scene.eevee.taa_samples = JOB["samples"]
    bpy.ops.wm.save_as_mainfile(filepath=JOB["blend"])


def lamp_of():
    return next(thing for thing in bpy.data.objects if thing.type == "LIGHT")


def mesh_of():
    return next(t for t in bpy.data.objects if t.type == "MESH" and t.data.materials)


def color_of():
    """The colour socket of a material's first shader."""
    nodes = mesh_of().data.materials[0].node_tree.nodes
    shader = next(n for n in nodes if n.type.startswith(("BSDF", "EMISSION")))
    return next(s for s in shader.inputs if s.name in ("Color", "Base Color"))


def orbit(view, k):
    from mathutils import Quaternion

    if view.view_perspective == "CAMERA":
        view.view_perspective = "PERSP"
        view.view_distance, view.view_location = 20.0, (0, 0, 0)
        view.view_rotation = Quaternion((1, 0, 0), 0.4)
    view.view_rotation = Quaternion((0, 0, 1), 0.02 * (1 + k)) @ view.view_rotation


# edit(scene, RegionView3D, k): k counts the calls, each makes another picture.
EDITS = {
    "shutter": lambda s, v, k: setattr(s.render, "motion_blur_shutter", 0.6 + 0.02 * k),
    "f-stop": lambda s, v, k: setattr(s.camera.data.dof, "aperture_fstop", 0.05 + 0.002 * k),
    "focus": lambda s, v, k: setattr(s.camera.data.dof, "focus_distance", 14.0 + 0.1 * k),
    "lamp strength": lambda s, v, k: setattr(
        lamp_of().data, "energy", lamp_of().data.energy * (1.2 if k == 0 else 1.03)
    ),
    "lamp color": lambda s, v, k: setattr(lamp_of().data, "color", (1, 0.7 - 0.01 * k, 0.5)),
    "material color": lambda s, v, k: setattr(
        color_of(), "default_value", (0.9, 0.2 + 0.01 * k, 0.1, 1)
    ),
    "object moved": lambda s, v, k: setattr(
        mesh_of(), "location", (0.1 + 0.02 * k, 0.1, mesh_of().location[2])
    ),
    "frame": lambda s, v, k: s.frame_set(s.frame_current + 1),
    "orbit": lambda s, v, k: orbit(v, k),
    "to camera": lambda s, v, k: setattr(v, "view_perspective", "CAMERA"),
}


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
    scene.camera.data.dof.use_dof = JOB.get("lens", True)
    if scene.camera.data.dof.aperture_fstop > 1:
        scene.camera.data.dof.aperture_fstop = 0.05
        scene.camera.data.dof.focus_distance = 15.0
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
