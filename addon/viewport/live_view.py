# SPDX-License-Identifier: GPL-3.0-or-later
"""One 3D view in Rendered shading, from its first to its last picture."""

import weakref
from time import perf_counter

import bpy
import numpy as np

from .. import bridge, passes
from ..export.base.report import ExportError, Report
from . import scene_reading
from .live_picture import LivePicture, coarse_crop
from .same import is_same
from .sight import read_sight
from .stages import LEAST_DIVISOR, Stage, next_divisor

POLL_SECONDS = 1.0 / 60.0
WAIT_SECONDS = 0.25  # while a final render has the machine
# The first picture of an edit is let through where it takes no longer: else a drag would show nothing.
PATIENCE_SECONDS = 0.2
# Between two drawings of a picture that is refined: each uploads it whole.
REFINE_SECONDS = 0.1

_EXPLAINED = (ExportError, bridge.NativeModuleMissing, bridge.DeviceError, bridge.RenderError)


class LiveView:
    """Belongs to one RenderEngine, which Blender frees with the view."""

    def __init__(self, engine):
        self._engine = weakref.ref(engine)
        self._picture = LivePicture()
        self._sight = None  # as the view stands now
        self._is_stale = False  # the scene is other than the snapshot
        self._has_moved = False  # the view is
        self._snapshot = None
        self._report = Report()
        self._job = None
        self._dying = []  # cancelled jobs that still run: their end is not waited for
        self._job_sight = None  # what it shows
        self._stage = None
        self._staging = None  # what the first picture has so far
        self._divisor = LEAST_DIVISOR
        self._began = self._drawn = 0.0
        self._waits = False
        self.counts = {"readings": 0, "jobs": 0, "settled": 0}

    @property
    def picture(self):
        return self._picture

    @property
    def is_alive(self):
        return self._engine() is not None

    @property
    def is_settled(self):
        return not (self._is_stale or self._has_moved or self._job)

    # Called by Blender.

    def update(self, context, depsgraph):
        """The scene has changed, or is shown for the first time."""
        if scene_reading.is_reading():
            return
        self._is_stale = True
        self._look(context, depsgraph)

    def draw(self, context, depsgraph):
        """The view is drawn: with what there is."""
        if not scene_reading.is_reading():
            self._look(context, depsgraph)
        self._picture.draw()

    def _look(self, context, depsgraph):
        pixel = max(int(self._engine().get_preview_pixel_size(depsgraph.scene)), 1)
        sight = read_sight(
            context.region, context.space_data, context.region_data, depsgraph, pixel
        )
        if sight != self._sight:
            self._has_moved = True
            before, self._sight = self._sight, sight
            # What is read depends on what a camera sees, and on how large.
            if before is None or sight.camera or before.camera or sight.scene != before.scene:
                self._is_stale = True

    # Called by the loop.

    def step(self):
        """Goes on; seconds until the next call, None where nothing is left to do."""
        self._dying = [job for job in self._dying if not job.done()]
        if bpy.app.is_job_running("RENDER"):
            return self._make_way()
        self._waits = False
        if self._is_stale or self._has_moved:
            if not self._shows_soon():
                self._begin()
        elif self._job is not None:
            self._go_on()
        if self._job is None and not (self._is_stale or self._has_moved):
            return POLL_SECONDS if self._dying else None
        return POLL_SECONDS

    def close(self):
        """Cancels and joins."""
        self._cancel()
        self._dying = []
        self._picture = LivePicture()

    def fail(self, text):
        """What went wrong stands in the view; what it shows stays."""
        self._cancel()
        self._is_stale = self._has_moved = False
        self._say(text)

    def _make_way(self):
        """A final render is under way: it has all threads, and the file is read by it."""
        if self._job is not None or self._is_stale or self._has_moved:
            self._cancel()
            self._is_stale = True
        if not self._is_stale:
            return None
        if not self._waits:
            self._waits = True
            self._say("Waits for the render")
        return WAIT_SECONDS

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
        scene_reading.settle()
        stale, self._is_stale = self._is_stale or self._snapshot is None, False
        moved, self._has_moved = self._has_moved, False
        if self._sight.is_empty:
            self._cancel()
            return
        try:
            bridge.load()
            if stale:
                before, self._snapshot = self._snapshot, None
                self._snapshot = self._read()
                if not moved and is_same(before, self._snapshot):
                    return  # something else was edited, or selected: a running job goes on
            self._cancel()
            self._start(Stage(self._divisor))
        except _EXPLAINED as error:
            self.fail(str(error))

    def _read(self):
        self._report = Report()
        self.counts["readings"] += 1
        sight = self._sight

        def viewpoint_of(scene):
            viewpoint = sight.viewpoint(scene)
            if viewpoint is None:
                raise ExportError(f"camera '{sight.camera}'", "is gone")
            return viewpoint

        snapshot = scene_reading.read_snapshot(sight.scene, sight.layer, viewpoint_of, self._report)
        scene = bpy.data.scenes[sight.scene]
        if self._picture.expose(passes.exposure_owner(scene).film_exposure):
            self._redraw()
        options = snapshot["options"]
        options["samples"] = scene.granita.preview_samples
        options["depth_pass"] = False
        return snapshot

    def _start(self, stage):
        snapshot, sight = self._snapshot, self._sight
        if not sight.camera:
            options = {
                **snapshot["options"],
                "width": sight.frame.width,
                "height": sight.frame.height,
                "crop": np.array(sight.crop, dtype=np.int32),
            }
            snapshot = {**snapshot, "options": options, "camera": sight.own_record()}
        self._stage, self._job_sight, self._began = stage, sight, perf_counter()
        self._job = bridge.begin(stage.snapshot(snapshot))
        self.counts["jobs"] += 1
        if not stage.is_last:
            x0, y0, x1, y1 = coarse_crop(sight.crop, stage.divisor)
            self._staging = np.zeros((y1 - y0, x1 - x0, 4), dtype=np.float32)
        self._say(f"Samples 0/{self._snapshot['options']['samples']}")

    def _go_on(self):
        """Takes what the job has finished."""
        is_done = self._job.done()  # asked first: no tile comes after
        tiles = self._job.take_tiles(0.0)
        if self._stage.is_last:
            for tile in tiles:
                self._picture.paste(tile.x, tile.y, tile.combined)
            if tiles and perf_counter() - self._drawn > REFINE_SECONDS:
                self._redraw()
        else:
            x0, y0, _, _ = coarse_crop(self._job_sight.crop, self._stage.divisor)
            for tile in tiles:
                values = tile.combined
                x, y = tile.x - x0, tile.y - y0
                self._staging[y : y + values.shape[0], x : x + values.shape[1]] = values
        if not (is_done or self._job.done()):
            return
        job, self._job = self._job, None
        try:
            bridge.end(job)
        except _EXPLAINED as error:
            self.fail(str(error))
            return
        if self._stage.is_last:
            self._settled(job)
        else:
            seconds = perf_counter() - self._began
            self._picture.replace(self._job_sight, self._staging, self._stage.divisor)
            self._divisor = next_divisor(self._divisor, seconds)
            self._redraw()
            if not (self._is_stale or self._has_moved):
                self._start(Stage(1))

    def _settled(self, job):
        self.counts["settled"] += 1
        samples = self._snapshot["options"]["samples"]
        warnings = len(self._report) + len(job.warnings())
        text = f"Samples {samples}/{samples}"
        if warnings:
            text += f" | {warnings} warning{'s' if warnings > 1 else ''}"
        self._say(text)
        self._redraw()

    def _cancel(self):
        if self._job is not None:
            self._job.cancel()
            self._dying.append(self._job)
            self._job = None

    def _say(self, text):
        engine = self._engine()
        if engine is not None:
            engine.update_stats("", text)
        self._redraw()

    def _redraw(self):
        self._drawn = perf_counter()
        engine = self._engine()
        if engine is not None:
            engine.tag_redraw()
