# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer of one final frame: depsgraph -> snapshot -> native render -> render result.

Everything here runs in the thread that Blender gave to `render()`; the native library has its own
threads and hands finished tiles over through one queue, waited for with the GIL released.
"""

from time import perf_counter

from . import bridge, passes
from .export import export_frame
from .export.base.report import Cancelled, Report, lines
from .properties import TILE_PIXELS
from .status_line import StatusLine

# Seconds between two looks at the cancel flag; well below the .5 s that an artist notices.
POLL_SECONDS = 0.05


class SettingsError(Exception):
    """The scene asks for what Granita cannot do; the text names it."""


class FinalRender:
    """Lives for one call of the engine's `render()`.

    `run` raises Cancelled, or an exception whose text names the cause; what the frame survived has
    then been told to the artist.
    """

    def __init__(self, engine, depsgraph, options, persistent_state):
        """`options`: of the command line; they win over the file.  `persistent_state`: of the engine."""
        self.engine = engine
        self.depsgraph = depsgraph
        self.options = options
        self.persistent_state = persistent_state
        self.scene = depsgraph.scene.name
        self.layer = depsgraph.view_layer.name
        self.passes = passes.wanted(depsgraph.view_layer)
        self.exposure = passes.exposure_owner(depsgraph.scene_eval).film_exposure
        self.status = StatusLine(engine)
        self.report = Report()
        self.seconds = {}

    def run(self, statistics):
        """Renders into the engine's result and adds the cost to `statistics`."""
        started = perf_counter()
        bridge.load()
        try:
            snapshot = self._export()
            options = snapshot["options"]
            job = self._render(snapshot)
            self.seconds["total"] = perf_counter() - started
            warnings = self.report.entries() + job.warnings()
            statistics.add_layer(self, options, job, warnings)
        finally:
            self._tell(self.report.entries())

    def _export(self):
        started = perf_counter()
        render = self.depsgraph.scene.render
        if render.use_multiview:
            raise SettingsError(f"scene '{self.scene}': stereoscopy is not supported")

        for name in passes.missing(self.depsgraph.view_layer):
            self.report(f"view layer '{self.layer}'", f"its pass {name} is not rendered")
        settings = self.depsgraph.scene_eval.granita
        persistent_state = self.persistent_state if render.use_persistent_data else None
        snapshot = export_frame(
            self.engine, self.depsgraph, settings, self.report, self._exporting, persistent_state
        )
        options = snapshot["options"]
        options.update(passes.requested(self.depsgraph.scene_eval, self.depsgraph.view_layer))
        options["bucket_size"] = -(-options["bucket_size"] // TILE_PIXELS) * TILE_PIXELS
        if self.options.device is not None:
            options["device"] = self.options.device
        if self.options.threads is not None:
            options["threads"] = self.options.threads

        self.depsgraph = None  # the next call frees it
        if not render.use_persistent_data:
            self.engine.free_blender_memory()
        self.seconds["export"] = perf_counter() - started
        return snapshot

    def _exporting(self):
        """Called often by the export."""
        if self.engine.test_break():
            raise Cancelled
        self.status.exporting()

    def _render(self, snapshot):
        """Runs the native job to its end and returns it.  Empties the snapshot."""
        started = perf_counter()
        origin = [int(pixel) for pixel in snapshot["options"]["crop"][:2]]
        job = None
        try:
            with bridge.rendering(snapshot) as job:
                self.seconds["scene"] = perf_counter() - started
                while not job.done():
                    self._deliver(job.take_tiles(POLL_SECONDS), origin)
                    if self.engine.test_break():
                        raise Cancelled
                    self.engine.update_progress(job.fraction)
                    self.status.rendering(job)
                self._deliver(job.take_tiles(0.0), origin)
        finally:
            if job is not None:
                self._tell(job.warnings())
        self.seconds["render"] = perf_counter() - started - self.seconds["scene"]
        return job

    def _deliver(self, tiles, origin):
        for tile in tiles:
            passes.deliver(self.engine, tile, self.passes, self.layer, origin, self.exposure)

    def _tell(self, warnings):
        for line in lines(warnings):
            self.engine.report({"WARNING"}, line)
