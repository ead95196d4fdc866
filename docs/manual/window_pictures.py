# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the manual's pictures of a 3D view in Rendered shading, in a window of its own under Xvfb.

    blender -b --factory-startup --addons granita --python docs/manual/window_pictures.py

The stage is that of pictures.py.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import pictures  # noqa: E402
from window_steps import take_steps  # noqa: E402

SIZE = "920x560"


def shutter(frames):
    def change(scene):
        scene.render.motion_blur_shutter = frames

    return change


def from_the_side(_scene):
    from mathutils import Quaternion

    view = area().spaces.active.region_3d
    view.view_perspective = "PERSP"
    view.view_location, view.view_distance = (0.2, 0, 0), 5.0
    view.view_rotation = Quaternion((1, 0, 0), 0.7)


SHOTS = {
    "view_shutter_half": shutter(0.5),
    "view_shutter_long": shutter(1.5),
    "view_side": from_the_side,
}


def make():
    """In background: the stage, and the window that shows it."""
    with tempfile.TemporaryDirectory() as folder:
        blend = str(Path(folder) / "stage.blend")
        scene = pictures.set_stage()
        scene.granita.samples = scene.granita.preview_samples = 64
        bpy.ops.wm.save_as_mainfile(filepath=blend)
        width, height = SIZE.split("x")
        subprocess.run(
            ["xvfb-run", "-a", "-s", f"-screen 0 {SIZE}x24", bpy.app.binary_path]
            + ["--factory-startup", "--addons", "granita", "--window-geometry", "0", "0"]
            + [width, height, blend, "--python", __file__, "--", folder],
            env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"},
            check=True,
        )
        for name in SHOTS:
            image = bpy.data.images.load(str(Path(folder) / f"{name}.png"))
            settings = bpy.context.scene.render.image_settings
            settings.file_format, settings.quality = "JPEG", 88
            bpy.context.scene.view_settings.view_transform = "Standard"
            image.save_render(str(pictures.FOLDER / f"{name}.jpg"))


def area():
    screen = bpy.context.window_manager.windows[0].screen
    return next(a for a in screen.areas if a.type == "VIEW_3D")


def shots(folder):
    """In the window; yields seconds to wait."""
    views = sys.modules["granita.viewport.loop"].views
    window = bpy.context.window_manager.windows[0]
    bpy.context.preferences.view.show_splash = False
    space = area().spaces.active
    space.region_3d.view_perspective = "CAMERA"
    space.region_3d.view_camera_zoom = 14.0
    space.shading.type = "RENDERED"
    yield 0.5
    for name, change in SHOTS.items():
        change(bpy.context.scene)
        yield 0.3
        while not all(view.is_settled for view in views()):
            yield 0.1
        yield 0.5
        with bpy.context.temp_override(window=window, screen=window.screen, area=area()):
            bpy.ops.screen.screenshot_area(filepath=str(Path(folder) / f"{name}.png"))
    bpy.ops.wm.quit_blender()


def main():
    if bpy.app.background:
        make()
        return
    take_steps(shots(sys.argv[-1]))


if __name__ == "__main__":
    main()
