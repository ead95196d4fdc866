# SPDX-License-Identifier: GPL-3.0-or-later
"""One 3D view in Rendered shading, from its first to its last picture.

edit -> the frame is read, its motion carried over -> coarse picture
     -> when edits rest: the shutter is read        -> the picture itself
"""

import weakref
from dataclasses import replace
from time import perf_counter

import bpy
import numpy as np

from .. import bridge, passes
from ..export.base.report import ExportError, counted, lines
from . import scene_reading
from .costs import DEAREST, Costs
from .live_picture import LivePicture, coarse_crop
from .motion_paths import DrawnPaths
from .one_time import at_time
from .scene_snapshots import SceneSnapshots
from .sight import read_sight
from .stages import LEAST_DIVISOR, Stage, next_divisor

POLL_SECONDS = 1.0 / 60.0
WAIT_SECONDS = 0.25  # while a final render has the machine
# The first picture of an edit is let through where it takes no longer: else a drag would show nothing.
PATIENCE_SECONDS = 0.2
# Without an edit, until the shutter is read and the picture itself is begun: within a drag neither is of use.  At
# least two drawings of the window, between which Blender hears of no edit.
REST_SECONDS = 0.08
# Beyond this it was not the drawing that took so long.
SLOW_DRAWING_SECONDS = 0.3
# Between two drawings of a picture that is refined: each uploads it whole.
REFINE_SECONDS = 0.1

_EXPLAINED = (ExportError, bridge.NativeModuleMissing, bridge.DeviceError, bridge.RenderError)


class LiveView:
    """Belongs to one RenderEngine, which Blender frees with the view."""

    def __init__(self, engine):
        self._engine = weakref.ref(engine)
        self._scene = SceneSnapshots()
        self._picture = LivePicture()
        self._shown = None  # snapshot and sight of the picture that is being made
        self._paths = DrawnPaths()  # over it
        self._sight = None  # as the view stands now
        self._is_stale = False  # the scene may be other than what was read
        self._has_moved = False  # the view is another
        self._is_unread = False  # the shutter is to be read once edits rest
        self._is_coarse = False  # what is shown is not the picture itself
        self._edited = 0.0  # when
        self._session = None  # of native code: what the next picture can use again
        self._job = None
        self._dying = []  # cancelled jobs that still run: their end is not waited for
        self._job_sight = None  # what it shows
        self._stage = None
        self._staging = None  # what the first picture has so far
        self._divisor = LEAST_DIVISOR
        self._began = self._drawn = 0.0
        self._waits = False
        self.region, self.looked = 0, 0.0  # address of the Region, and when it was drawn last
        self._stepped = self._drawing = (
            0.0  # when step() ended last; seconds of the window's last drawing
        )
        self.kept_pixels = None  # of a picture that later ones are compared with
        self.costs = Costs()
        self.warnings = []  # of the picture, a line each
        self.counts = dict.fromkeys(
            ("frames read", "shutters read", "jobs", "pictures", "settled"), 0
        )

    @property
    def picture(self):
        return self._picture

    @property
    def is_alive(self):
        return self._engine() is not None

    @property
    def is_settled(self):
        is_made = not (self._is_edited or self._is_unread or self._is_coarse or self._job)
        return is_made and self._has_its_paths

    @property
    def _has_its_paths(self):
        return self._shown is None or self._paths.are_of(*self._shown)

    @property
    def _is_edited(self):
        return self._is_stale or self._has_moved

    # Called by Blender.

    def update(self, context, depsgraph):
        """The scene has changed, or is shown for the first time."""
        if scene_reading.is_reading():
            return
        self._scene.note(depsgraph)
        self._is_stale, self._edited = True, perf_counter()
        self._look(context, depsgraph)

    def draw(self, context, depsgraph):
        """The view is drawn: with what there is."""
        if not scene_reading.is_reading():
            self._look(context, depsgraph)
        self._picture.draw()
        self._paths.wanted = context.space_data.shading.granita.use_paths
        self._paths.draw()

    def _look(self, context, depsgraph):
        self.region, self.looked = context.region.as_pointer(), perf_counter()
        pixel = max(int(self._engine().get_preview_pixel_size(depsgraph.scene)), 1)
        sight = read_sight(
            context.region, context.space_data, context.region_data, depsgraph, pixel
        )
        if sight != self._sight:
            self._has_moved, self._edited = True, perf_counter()
            before, self._sight = self._sight, sight
            # What is read depends on what a camera sees, and on how large.
            if before is None or _reads_other(before, sight):
                self._is_stale = True

    # Called by the loop.

    def forget(self):
        """An undo, say: nothing that was noted is true any more."""
        self._scene.forget()
        self._is_stale, self._edited = True, perf_counter()

    def step(self):
        """Goes on; seconds until the next call, None where nothing is left to do."""
        if self.looked > self._stepped:
            self._drawing = min(perf_counter() - self.looked, SLOW_DRAWING_SECONDS)
        try:
            return self._step()
        finally:
            self._stepped = perf_counter()

    def _step(self):
        self._dying = [job for job in self._dying if not job.done()]
        if not self._has_its_paths:
            self._redraw()
        if bpy.app.is_job_running("RENDER"):
            return self._make_way()
        self._waits = False
        if self._is_paused():
            return None
        scene_reading.settle()
        try:
            if self._is_edited:
                if not self._shows_soon():
                    self._begin()
            elif self._job is not None:
                self._go_on()
            elif self._is_unread or self._is_coarse:
                self._rest()
        except _EXPLAINED as error:
            self.fail(str(error))
        return None if self.is_settled and not self._dying else POLL_SECONDS

    def close(self):
        """Cancels and joins."""
        self._cancel()
        self._dying = []
        self._session = None
        self._picture = LivePicture()

    def fail(self, text):
        """What went wrong stands in the view; what it shows stays."""
        self._cancel()
        self._is_stale = self._has_moved = self._is_unread = self._is_coarse = False
        self._say(text)

    def _make_way(self):
        """A final render is under way: it has all threads, and the file is read by it."""
        if not self.is_settled:
            self._cancel()
            self._is_stale = True
        if not self._is_stale:
            return None
        if not self._waits:
            self._waits = True
            self._say("Waits for the render")
        return WAIT_SECONDS

    def _is_paused(self):
        scene = bpy.data.scenes.get(self._sight.scene) if self._sight is not None else None
        if scene is None or not scene.granita.preview_pause:
            return False
        if self._job is not None:
            self._cancel()
            self._is_coarse = True
            self._say("Paused")
        return True

    def _shows_soon(self):
        if self._job is None or self._stage.is_last:
            return False
        self._go_on()
        return (
            self._job is not None
            and not self._stage.is_last
            and perf_counter() - self._began < PATIENCE_SECONDS
        )

    def _begin(self):
        """The first picture of an edit."""
        stale, self._is_stale = self._is_stale or self._scene.snapshot is None, False
        moved, self._has_moved = self._has_moved, False
        if self._sight.is_empty:
            self._cancel()
            self._is_unread = self._is_coarse = False
            return
        bridge.load()
        if stale:
            self.counts["frames read"] += 1
            began = perf_counter()
            shows = self._scene.read_frame(self._sight)
            self.costs.frame = perf_counter() - began
            if self._picture.expose(self._scene.exposure):
                self._redraw()
            self._is_unread = not (self._scene.is_exact and self._scene.is_current)
            if not (shows or moved):
                return  # something else was edited, or selected: a running job goes on
        if self._job is not None and not self._stage.is_last:
            self._divisor = next_divisor(self._stage.divisor, perf_counter() - self._began)
        self._cancel()
        self._is_coarse = True
        self._start(Stage(self._first_divisor()))
        # So that the window's next drawing shows it, for no longer than that takes: without, each picture of a drag
        # would cost a drawing of the one before it.
        hold = min(self._drawing, PATIENCE_SECONDS)
        while self._job is not None and (left := self._began + hold - perf_counter()) > 0.0:
            self._go_on(left)

    def _rest(self):
        """The picture itself, once edits rest."""
        rest = max(REST_SECONDS, 2.0 * self._drawing)
        if perf_counter() - self._edited < rest or _plays():
            return
        if self._is_unread:
            self._is_unread = False
            if not self._scene.is_current:
                self._is_coarse |= self._scene.read_frame(self._sight, looks_at_paintings=True)
            if not self._scene.is_exact:
                self.counts["shutters read"] += 1
                began = perf_counter()
                self._is_coarse |= self._scene.read_shutter(self._sight)
                self.costs.shutter = perf_counter() - began
        if self._is_coarse:
            self._start(Stage(1))

    def _first_divisor(self):
        wanted = bpy.data.scenes[self._sight.scene].granita.preview_moving
        return self._divisor if wanted == "AUTO" else int(wanted)

    def _start(self, stage):
        snapshot, sight = self._scene.snapshot, self._sight
        if not sight.camera:
            options = {
                **snapshot["options"],
                "width": sight.frame.width,
                "height": sight.frame.height,
                "crop": np.array(sight.crop, dtype=np.int32),
            }
            snapshot = {**snapshot, "options": options, "camera": sight.own_record()}
        self._shown = snapshot, sight
        if sight.look.time is not None:
            snapshot = at_time(snapshot, sight.look.time)
        self._stage, self._job_sight, self._began = stage, sight, perf_counter()
        if self._session is None:
            self._session = bridge.new_session()
        self._job = bridge.begin(stage.snapshot(snapshot), self._session)
        self.counts["jobs"] += 1
        if not stage.is_last:
            x0, y0, x1, y1 = coarse_crop(sight.crop, stage.divisor)
            self._staging = np.zeros((y1 - y0, x1 - x0, 4), dtype=np.float32)
            # Shown with the picture: a drawing of its own would cost as much as that one.
            self._say(f"Samples 0/{snapshot['options']['samples']}", now=False)

    def _go_on(self, seconds=0.0):
        """Takes what the job has finished; waits at most so long for some of it."""
        is_done = self._job.done()  # asked first: no tile comes after
        tiles = self._job.take_tiles(seconds)
        if self._stage.is_last:
            for tile in tiles:
                self._picture.paste(tile.x, tile.y, self._pixels_of(tile))
            if tiles and perf_counter() - self._drawn > REFINE_SECONDS:
                self._redraw()
        else:
            x0, y0, _, _ = coarse_crop(self._job_sight.crop, self._stage.divisor)
            for tile in tiles:
                values = self._pixels_of(tile)
                x, y = tile.x - x0, tile.y - y0
                self._staging[y : y + values.shape[0], x : x + values.shape[1]] = values
        if not (is_done or self._job.done()):
            return
        job, self._job = self._job, None
        bridge.end(job)
        if self._stage.is_last:
            self._settled(job)
        else:
            self.counts["pictures"] += 1
            self.costs.first = perf_counter() - self._began
            self.costs.divisor = self._stage.divisor
            is_anew = job.statistics()["buckets_seen_before"] == 0
            self._divisor = next_divisor(self._stage.divisor, self.costs.first, is_anew)
            self._picture.replace(self._job_sight, self._staging, self._stage.divisor)
            self._redraw()

    def _pixels_of(self, tile):
        return passes.shown_pixels(tile, self._job_sight.look.shown.native)

    def _settled(self, job):
        self._is_coarse = False
        self.counts["settled"] += 1
        self.costs.whole = perf_counter() - self._began
        self.costs.statistics = job.statistics()
        self.costs.objects = job.dearest_objects(DEAREST)
        samples = self._scene.snapshot["options"]["samples"]
        self.warnings = lines(self._scene.report.entries() + job.warnings())
        text = f"Samples {samples}/{samples}"
        if self.warnings:
            text += f" | {counted(len(self.warnings), 'warning')}"
        self._say(text)
        self._redraw()

    def _cancel(self):
        if self._job is not None:
            self._job.cancel()
            self._dying.append(self._job)
            self._job = None

    def _say(self, text, now=True):
        engine = self._engine()
        if engine is not None:
            engine.update_stats("", text)
        if now:
            self._redraw()

    def _redraw(self):
        self._drawn = perf_counter()
        self._picture.prepare()
        if self._shown is not None:
            self._paths.prepare(*self._shown)
        engine = self._engine()
        if engine is not None:
            engine.tag_redraw()


def _reads_other(before, sight):
    """Whether the scene is to be read again, of which depends what a camera sees, and how large; not for another place
    of a view of its own, nor for another time within the shutter."""
    a, b = (replace(s, look=replace(s.look, time=None)) for s in (before, sight))
    if a.camera or b.camera or a.scene != b.scene:
        return a != b
    return a.look != b.look


def _plays():
    """Whether an animation is played: of its frames the first pictures alone are made."""
    windows = bpy.context.window_manager.windows
    return any(window.screen.is_animation_playing for window in windows)
