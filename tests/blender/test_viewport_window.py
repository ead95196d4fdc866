# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered shading in a window: its own pixels, an edit, an undo, other engines and back.  Under Xvfb; needs a
Blender with windows."""

import bpy
import scene_parts as parts
import window_host

pytestmark = window_host.needed

WATCH = """
import sys, time
import numpy as np
window = bpy.context.window_manager.windows[0]
area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
region = next(r for r in area.regions if r.type == "WINDOW")
space = area.spaces.active
scene = bpy.context.scene
loop = sys.modules["granita.viewport.loop"]

def settled():
    deadline = time.monotonic() + 40
    yield 0.2
    while not (loop.views() and all(view.is_settled for view in loop.views())):
        if time.monotonic() > deadline:
            raise RuntimeError("does not settle")
        yield 0.02
    yield 0.3  # it is drawn

def middle():
    # 8-bit colour of the window in the middle of the view
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.screen.screenshot(filepath=OUT + ".png")
    image = bpy.data.images.load(OUT + ".png")
    image.colorspace_settings.name = "Raw"
    width, height = image.size
    pixels = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    x, y = region.x + region.width // 2, region.y + region.height // 2
    return [round(255 * float(v)) for v in pixels.reshape(height, width, 4)[y, x, :3]]

def steps():
    space.overlay.show_overlays = False
    space.show_gizmo = False
    space.region_3d.view_perspective = "CAMERA"
    space.shading.type = "RENDERED"
    yield from settled()
    found["first"] = middle()
    yield from settled()  # the screenshot was an image of the file for a moment
    found["is_idle"] = not bpy.app.timers.is_registered(loop._step)
    counts = dict(loop.views()[0].counts)
    yield 0.5
    found["stays_idle"] = counts == loop.views()[0].counts
    node = next(n for n in bpy.data.materials["Glow"].node_tree.nodes if n.type == "EMISSION")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.ed.undo_push(message="before")
        node.inputs["Color"].default_value = (1, 0, 0, 1)
        bpy.ops.ed.undo_push(message="red")
    yield from settled()
    found["edited"] = middle()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.ed.undo()
    yield from settled()
    found["undone"] = middle()
    shown = space.shading.granita
    shown.use_paths = True
    yield from settled()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.granita_keep_picture()
    shown.render_pass = "NORMAL"
    area.tag_redraw()
    yield from settled()
    found["pass"] = middle()
    yield from settled()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.granita_compare_pictures()
    found["compared"] = "Granita Comparison" in bpy.data.images
    shown.render_pass = "COMBINED"
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.scene.collection.objects.link(empty)
    for thing in bpy.context.scene.objects:
        thing.select_set(thing == empty)
    for name in ("local", "global"):
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.view3d.localview(frame_selected=False)
        yield from settled()
        found[name] = middle()
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.screen.region_quadview()
    yield from settled()
    found["quad"] = len(loop.views())
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.screen.region_quadview()
    for engine in ("BLENDER_WORKBENCH", "GRANITA"):
        scene = bpy.context.scene
        scene.render.engine = engine
        yield 0.3
        found[engine] = len(loop.views())
    yield from settled()
    found["again"] = middle()
    import addon_utils
    bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
    addon_utils.disable("granita")
    yield 0.3
    found["end"] = True
"""


def test_a_window_shows_and_follows_what_is_edited(scene, tmp_path):
    parts.add_camera(scene, ortho_scale=1.0)
    parts.add_square(scene, size=4.0, material=parts.emission("Glow", (0.25, 0.5, 0.75)))
    scene.view_settings.view_transform = "Standard"
    blend = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
    found, said = window_host.watch(WATCH, tmp_path, blend)
    glow = [137, 188, 225]  # sRGB of .25, .5, .75
    assert found == {
        "first": glow,
        "is_idle": True,
        "stays_idle": True,
        "edited": [255, 0, 0],
        "undone": glow,
        "pass": [0, 0, 255],
        "compared": True,
        "local": [0, 0, 0],
        "global": glow,
        "quad": 4,
        "BLENDER_WORKBENCH": 0,
        "GRANITA": 1,
        "again": glow,
        "end": True,
    }, said
