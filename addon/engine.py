# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine as Blender sees it: forwards, and turns every failure into exit code 1.

No exception leaves `render()`: Blender would print it, save a black frame and exit with 0, or
crash while saving a float file.  `report({'ERROR'})` alone makes `blender -b` stop without a file
and exit with 1; `error_set` adds the banner in the window.
"""

import gc
import threading
import time
import weakref
from contextlib import contextmanager

import bpy

from . import (
    bridge,
    command_line,
    fault,
    final_merge,
    final_render,
    frame_statistics,
    interrupts,
    passes,
    preview_render,
    turn_of_python,
    written_frames,
)
from .event_log import EventLog
from .export import PersistentState
from .export.base.report import Cancelled, ExportError, escaped
from .export.shading.image import forget_images
from .handlers import registration
from .parts.part_file import PartError
from .viewport import loop
from .viewport.live_view import LiveView

ENGINE_ID = "GRANITA"

# Failures whose text says all an artist can use; any other is a fault of ours and gets a traceback.
_EXPLAINED = (
    ExportError,
    bridge.NativeModuleMissing,
    bridge.DeviceError,
    bridge.RenderError,
    command_line.CommandLineError,
    final_render.SettingsError,
    frame_statistics.StatisticsFileError,
    PartError,
)
_INTERRUPTED = "interrupted"
# Seconds for which the add-on's end waits for renders.
_PATIENCE = 10.0
_rendering = weakref.WeakSet()  # engines, until Blender has freed them
_ends = False  # with the add-on


class GranitaRenderEngine(bpy.types.RenderEngine):
    bl_idname = ENGINE_ID
    bl_label = "Granita"
    bl_use_preview = True
    bl_use_postprocess = True  # else the compositor and the normal way of saving are skipped
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False  # Cycles' and EEVEE's nodes are ours
    bl_use_gpu_context = False

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        turn_of_python.await_turn()  # a preview's: no handler tells of these
        self.frame_statistics = frame_statistics.FrameStatistics()
        self.log = EventLog()
        self.persistent_state = PersistentState()
        self.live_view = None  # of the engine of a 3D view
        self.thread = None  # that it renders in

    def update_render_passes(self, scene=None, renderlayer=None):
        """Blender calls it at any change of the view layer, without a net: what goes wrong is told, and
        the passes that were registered before it stand."""
        try:
            passes.register(self, scene, renderlayer)
        except Exception as error:
            self.report({"ERROR"}, escaped(f"passes: {fault.traced(error)}"))

    def is_cancelled(self):
        return _ends or self.test_break() or interrupts.came() and not self.is_preview

    def render(self, depsgraph):
        stays = False
        try:
            turn_of_python.started()
            stays = not self.is_preview and depsgraph.scene.render.use_persistent_data
            self.thread = threading.get_ident()
            _rendering.add(self)
            self._render(depsgraph)
        except KeyboardInterrupt:
            self._fail(_INTERRUPTED)
        finally:
            if stays:
                _rendering.discard(self)
            if not self.is_preview:
                turn_of_python.ended()

    def _render(self, depsgraph):
        try:
            if self.is_preview and turn_of_python.interrupts_drawing():
                return  # the icon stays empty until its datablock changes
            if self.is_preview:
                preview_render.render_preview(self, depsgraph)
                return
            self.log = EventLog(command_line.log_kind(), depsgraph.scene.frame_current)
            options = command_line.parse()
            if lost := written_frames.problem():
                self._fail(lost)
                return
            if options.merge is not None:
                final_merge.FinalMerge(self, depsgraph, options).run()
                return
            self.frame_statistics.open(options.stats)
            final_render.FinalRender(self, depsgraph, options, self.persistent_state).run(
                self.frame_statistics
            )
        except Cancelled:
            self._give_up()
            if interrupts.came():
                self._fail(_INTERRUPTED)
            elif not self.test_break():  # else Blender would keep an empty frame and go on
                ended = "the add-on was switched off"
                self._fail(ended if _ends else "the render stopped without being asked to")
        except _EXPLAINED as error:
            self._fail(str(error))
        except Exception as error:
            self._fail(fault.traced(error))

    def render_frame_finish(self):
        try:
            if not self.is_preview:
                self.frame_statistics.write()
                written_frames.is_rendered()
        except _EXPLAINED as error:
            self._fail(str(error))
        except KeyboardInterrupt:
            self._fail(_INTERRUPTED)

    def view_update(self, context, depsgraph):
        with _told(self):
            self._live_view().update(context, depsgraph)
            loop.wake()

    def view_draw(self, context, depsgraph):
        with _told(self):
            view = self._live_view()
            view.draw(context, depsgraph)
            if not view.is_settled:
                loop.wake()

    def _live_view(self):
        if self.live_view is None:
            self.live_view = LiveView(self)
            loop.add(self.live_view)
        return self.live_view

    def _give_up(self):
        self.frame_statistics.discard()
        if not self.is_preview:
            written_frames.is_given_up()

    def _fail(self, text):
        self._give_up()
        self.log.error(text)
        self.report({"ERROR"}, escaped(text))
        self.error_set(escaped(text))


@contextmanager
def _told(engine):
    """A fault inside a 3D view stands in its corner: Blender would call again and again."""
    try:
        yield
    except Exception as error:
        engine.update_stats("", escaped(fault.traced(error)))


_add_handlers, _remove_handlers = registration(("render_init", forget_images))


def _end_renders():
    """Blender forgets an engine's class with the add-on, also where one renders in another thread, a preview.
    One of this thread, in a handler of which the add-on is taken away, ends after it: waiting would be in vain."""
    global _ends
    _ends = True
    gc.collect()  # what a failure may hold
    end = time.monotonic() + _PATIENCE
    own = threading.get_ident()
    while any(engine.thread != own for engine in _rendering) and time.monotonic() < end:
        time.sleep(0.005)
    _ends = False


def register():
    bpy.utils.register_class(GranitaRenderEngine)
    _add_handlers()
    interrupts.register()
    turn_of_python.register()
    loop.register()


def unregister():
    loop.unregister()
    turn_of_python.unregister()
    interrupts.unregister()
    _remove_handlers()
    _end_renders()
    turn_of_python.started()  # nobody else tells any more that they have
    bpy.utils.unregister_class(GranitaRenderEngine)
