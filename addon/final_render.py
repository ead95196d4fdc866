# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer of one final frame: depsgraph -> snapshot -> native render -> render result.

Everything here runs in the thread that Blender gave to `render()`; the native library has its own
threads and hands finished tiles over through one queue, waited for with the GIL released.
"""

from time import perf_counter

import bpy
import numpy as np

from . import bridge, passes
from .event_log import EventLog
from .export import export_frame
from .export.base.report import Cancelled, Report, lines
from .frame_memory import largest_geometry, largest_mesh, memory_limit
from .parts.coarse_look import coarse, tile_costs
from .parts.frame_cut import FrameCut
from .parts.part_output import folder_of, output_path
from .parts.picture_digest import file_digest, picture_digest
from .properties import TILE_PIXELS
from .status_line import StatusLine, layers_done

# Seconds between two looks at the cancel flag; well below the .5 s that an artist notices.
POLL_SECONDS = 0.05
MUCH_MEMORY = 1 << 20  # bytes that the export says before it takes them


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
        self.memory = memory_limit(options.memory)
        self.memory_looked_at = -POLL_SECONDS  # by perf_counter
        self.largest = ""  # thing of the scene, in words
        self.persistent_state = persistent_state
        self.scene = depsgraph.scene.name
        self.layer = depsgraph.view_layer.name
        self.passes = passes.wanted(depsgraph.view_layer)
        self.exposure = passes.exposure_owner(depsgraph.scene_eval).film_exposure
        self.frame = depsgraph.scene.frame_current
        self.log = EventLog(options.log, self.frame, self.layer)
        self.status = StatusLine(engine, self.log, *layers_done(engine, depsgraph))
        self.report = Report()
        self.seconds = {}
        self.origin = None  # the result's lower-left pixel in the frame
        self.cut = None  # FrameCut, where the frame is rendered in parts
        self.part = None  # CollectedPart, where one of them is rendered

    def run(self, statistics):
        """Renders into the engine's result and adds the cost to `statistics`."""
        started = perf_counter()
        bridge.load()
        try:
            snapshot = self._export()
            options = snapshot["options"]
            if self.options.cut is not None:
                self._cut_by_cost(snapshot)
                return
            if self.part is not None and self.part.rect is None:
                self._end_empty()
                self.part.write()
                return
            job = self._render(snapshot)
            if self.part is not None:
                self.part.write()
            self.seconds["total"] = perf_counter() - started
            warnings = self.report.entries() + job.warnings()
            statistics.add_layer(self, options, job, warnings)
            self.status.rendered()
            self.log.layer(self.seconds)
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
        self.origin = [int(pixel) for pixel in options["crop"][:2]]
        options["bucket_size"] = -(-options["bucket_size"] // TILE_PIXELS) * TILE_PIXELS
        if self.options.device is not None:
            options["device"] = self.options.device
        if self.options.threads is not None:
            options["threads"] = self.options.threads
        if self.memory is not None:
            options["memory"] = self.memory.mebibytes
        self.largest = largest_geometry(snapshot["geometries"])

        if self.options.part is not None or self.options.cut is not None:
            self.cut = self._frame_cut(snapshot)
        if self.options.part is not None:
            self._cut_part(options)

        self.depsgraph = None  # the next call frees it
        if not render.use_persistent_data:
            self.engine.free_blender_memory()
        self.seconds["export"] = perf_counter() - started
        return snapshot

    def _frame_cut(self, snapshot):
        options = snapshot["options"]
        core = bridge.load()
        origin = {
            "frame": int(options["frame"]),
            "scene": self.scene,
            "layer": self.layer,
            "granita": core.__version__,
            "build": file_digest(core.__file__),
            "blender": bpy.app.version_string,
            "picture": picture_digest(snapshot),
        }
        folder = folder_of(self.options, output_path(self.depsgraph.scene))
        crop = tuple(int(pixel) for pixel in options["crop"])
        return FrameCut(folder, origin, crop, TILE_PIXELS)

    def _cut_part(self, options):
        """Leaves of the picture the part that the command line names."""
        channels = [(p.native, p.channels) for p in self.passes]
        self.part = self.cut.part(self.options.part, channels)
        if self.part.rect is not None:
            options["crop"] = np.array(self.part.rect, dtype=np.int32)

    def _cut_by_cost(self, snapshot):
        """Says how the parts are to be cut, by a coarse look at the frame."""
        look = self._render(coarse(snapshot, TILE_PIXELS), deliver=lambda tiles: None)
        costs = tile_costs(look.bucket_seconds(), self.cut.crop, TILE_PIXELS)
        self.cut.write(self.options.cut, costs)
        self._end_empty()

    def _end_empty(self):
        """A result without pixels still has to be complete: Blender crashes where it saves none."""
        self.engine.end_result(self.engine.begin_result(0, 0, 1, 1, layer=self.layer))
        self.status.rendered()

    def _exporting(self, wanted):
        """Called often by the export, which is about to take `wanted` bytes."""
        if self.engine.is_cancelled():
            raise Cancelled
        if self.memory is not None:
            self._check_memory(wanted)
        self.status.exporting()

    def _check_memory(self, wanted):
        """Of the export; the render looks itself."""
        now = perf_counter()
        if wanted < MUCH_MEMORY and now - self.memory_looked_at < POLL_SECONDS / 5:
            return  # a look takes a hundredth of a millisecond: too long for each of many small objects
        self.memory_looked_at = now
        limit, held = self.memory.mebibytes, bridge.load().process_memory()
        if held + wanted > limit << 20:
            self.largest = self.largest or largest_mesh(self.depsgraph)
            taken = f"{held >> 20} MiB are taken by Blender and the scene"
            if wanted >> 20:
                taken += f", {wanted >> 20} MiB more are wanted"
            raise SettingsError(
                self._about_memory(
                    f"the export wants more memory than {limit} MiB, its limit: {taken}"
                )
            )

    def _about_memory(self, text):
        """With what helps who reads that memory does not suffice."""
        origin = self.memory.origin if self.memory is not None else ""
        return "; ".join(filter(None, (text, self.largest, origin)))

    def _render(self, snapshot, deliver=None):
        """Runs the native job to its end and returns it.  Empties the snapshot."""
        started = perf_counter()
        deliver = deliver or self._deliver
        job = None
        try:
            with bridge.rendering(snapshot, self._about()) as job:
                self.seconds["scene"] = perf_counter() - started
                while not job.done():
                    deliver(job.take_tiles(POLL_SECONDS))
                    if self.engine.is_cancelled():
                        raise Cancelled
                    self.status.rendering(job)
                deliver(job.take_tiles(0.0))
        except bridge.MemoryShort as error:
            raise SettingsError(self._about_memory(str(error))) from error
        finally:
            if job is not None:
                self._tell(job.warnings())
        self.seconds["render"] = perf_counter() - started - self.seconds["scene"]
        return job

    def _about(self):
        """What a report of a crash begins with."""
        core = bridge.load()
        return (
            f"Granita {core.__version__}, build {file_digest(core.__file__)}, "
            f"in Blender {bpy.app.version_string}\n"
            f"scene '{self.scene}', view layer '{self.layer}', frame {self.frame}, "
            f"file '{bpy.data.filepath}'"
        )

    def _deliver(self, tiles):
        for tile in tiles:
            if self.part is not None:
                self.part.add(tile, passes.tile_arrays(tile))
            passes.deliver(self.engine, tile, self.passes, self.layer, self.origin, self.exposure)

    def _tell(self, warnings):
        for line in lines(warnings):
            self.engine.report({"WARNING"}, line)
            self.log.warning(line)
