# SPDX-License-Identifier: GPL-3.0-or-later
"""A 3D view without a window: the same code is driven that Blender calls from one.

Only the engine's own calls, the region's size and the two matrices are stood in for.
"""

import time
from types import SimpleNamespace

import bpy
from mathutils import Matrix

# Where a script sees what an evaluation touched, as `view_update` does.
HANDLERS = ("depsgraph_update_post", "frame_change_post")
SECONDS = 60.0  # after which a view is not going to settle


class StandInEngine:
    """What a view asks of its RenderEngine."""

    def __init__(self):
        self.redraws, self.texts = 0, []

    def get_preview_pixel_size(self, _scene):
        return 1

    def tag_redraw(self):
        self.redraws += 1

    def update_stats(self, _stats, text):
        self.texts.append(text)


class View:
    """`size`: of the region, pixels."""

    def __init__(self, size):
        import sys

        live_view = sys.modules["granita.viewport.live_view"]
        self.engine = StandInEngine()
        self.live = live_view.LiveView(self.engine)
        self.region = SimpleNamespace(width=size[0], height=size[1], as_pointer=lambda: 0)
        shown = SimpleNamespace(render_pass="COMBINED", use_time=False, time=0.5, use_paths=False)
        types = (
            n for n in bpy.types.SpaceView3D.bl_rna.properties.keys() if n[:12] == "show_object_"
        )
        self.space = SimpleNamespace(
            use_local_camera=False,
            camera=None,
            use_render_border=False,
            clip_start=0.01,
            clip_end=1000.0,
            local_view=None,
            use_local_collections=False,
            shading=SimpleNamespace(granita=shown),
            **dict.fromkeys(types, True),
        )
        self.region_data = None
        for evaluated in HANDLERS:
            getattr(bpy.app.handlers, evaluated).append(self._evaluated)

    def close(self):
        for evaluated in HANDLERS:
            getattr(bpy.app.handlers, evaluated).remove(self._evaluated)
        self.live.close()

    def _evaluated(self, _scene, depsgraph):
        if self.region_data is not None:
            self.live.update(self._context(depsgraph), depsgraph)

    def look_through_camera(self):
        """At one region pixel a frame pixel, without zoom or offset."""
        self.region_data = SimpleNamespace(view_perspective="CAMERA")
        return self

    def look_from(self, view, window):
        """`view`, `window`: [4, 4], as of RegionView3D."""
        self.region_data = SimpleNamespace(
            view_perspective="PERSP", view_matrix=Matrix(view), window_matrix=Matrix(window)
        )
        return self

    def _context(self, depsgraph):
        if self.region_data.view_perspective == "CAMERA":
            camera = bpy.context.scene.camera.evaluated_get(depsgraph)
            window = camera.calc_matrix_camera(depsgraph, x=self.region.width, y=self.region.height)
            view = camera.matrix_world.normalized().inverted()
            self.region_data.perspective_matrix = window @ view
        return SimpleNamespace(
            region=self.region, space_data=self.space, region_data=self.region_data
        )

    def edited(self):
        """Blender evaluates an edit and tells of it."""
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        self.live.update(self._context(depsgraph), depsgraph)
        return self

    def drawn(self):
        """Blender draws: without a window, all but the drawing itself."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        self.live._look(self._context(depsgraph), depsgraph)
        return self

    def step(self):
        return self.live.step()

    def settle(self):
        """Goes on until nothing is left to do; the picture, float32 [h, w, 4]."""
        deadline = time.monotonic() + SECONDS
        while self.step() is not None:
            assert time.monotonic() < deadline, self.engine.texts[-3:]
            time.sleep(0.002)
        return self.live.picture.pixels
