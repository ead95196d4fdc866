# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer of one final frame: depsgraph -> snapshot -> native render -> render result.

Everything here runs in the thread that Blender gave to `render()`; the native library has its own
threads and hands finished tiles over through one queue, waited for with the GIL released.
"""

from time import perf_counter

from . import bridge, command_line, frame_statistics, passes
from .export import export_frame
from .export.report import Cancelled, Report
from .status_line import StatusLine

# Seconds between two looks at the cancel flag; well below the .5 s that an artist notices.
POLL_SECONDS = 0.05


class SettingsError(Exception):
    """The scene asks for what Granita cannot do; the text names it."""


def render(engine, depsgraph, statistics):
    """Renders `depsgraph`'s view layer into `engine`'s result and adds its cost to `statistics`.

    Raises Cancelled, or an exception whose text names the cause.
    """
    started = perf_counter()
    options = command_line.parse()
    if options.stats:
        frame_statistics.check_writable(options.stats)
    bridge.load()
    scene = depsgraph.scene
    if scene.render.use_multiview:
        raise SettingsError(f"scene '{scene.name}': stereoscopy is not supported")

    status = StatusLine(engine)
    report = Report()

    def check_cancel():
        if engine.test_break():
            raise Cancelled
        status.exporting()

    try:
        layer = _Layer(depsgraph)
        settings = depsgraph.scene_eval.granita
        snapshot = export_frame(engine, depsgraph, settings, report, check_cancel)
        _apply(options, snapshot["options"])
        seconds = {"export": perf_counter() - started}
        if not scene.render.use_persistent_data:
            # From here on nothing may touch the depsgraph.
            engine.free_blender_memory()
        job = _render_somewhere(engine, layer, snapshot, seconds, report, status)
        seconds["total"] = perf_counter() - started
        warnings = report.entries() + job.warnings()
        statistics.add_layer(layer, snapshot["options"], job, seconds, warnings)
    finally:
        _tell(engine, report.entries())


class _Layer:
    """What is needed of the view layer after Blender's memory was freed."""

    def __init__(self, depsgraph):
        self.name = depsgraph.view_layer.name
        self.scene_name = depsgraph.scene.name
        self.passes = passes.wanted(depsgraph.view_layer)


def _apply(command_line_options, snapshot_options):
    """The command line wins over the file."""
    if command_line_options.device is not None:
        snapshot_options["device"] = command_line_options.device
    if command_line_options.threads is not None:
        snapshot_options["threads"] = command_line_options.threads


def _render_somewhere(engine, layer, snapshot, seconds, report, status):
    """On the device asked for; without a usable one on the CPU, which is said when it was asked for."""
    try:
        return _run(engine, layer, snapshot, seconds, report, status)
    except bridge.DeviceError as error:
        asked = snapshot["options"]["device"]
        if asked == "CPU":
            raise bridge.RenderError(str(error)) from error
        if asked == "GPU":
            report.warn(
                f"scene '{layer.scene_name}'", f"rendered on the CPU, no usable GPU: {error}"
            )
    snapshot["options"]["device"] = "CPU"
    return _run(engine, layer, snapshot, seconds, report, status)


def _run(engine, layer, snapshot, seconds, report, status):
    """Runs one native job to its end and returns it."""
    started = perf_counter()
    job = None
    try:
        with bridge.rendering(snapshot) as job:
            seconds["scene"] = perf_counter() - started
            origin = snapshot["options"]["crop"][:2]
            while not job.done():
                _deliver(engine, job, POLL_SECONDS, layer, origin)
                if engine.test_break():
                    raise Cancelled
                engine.update_progress(job.fraction)
                status.rendering(job)
            _deliver(engine, job, 0.0, layer, origin)
    finally:
        if job is not None:
            _tell(engine, job.warnings())
    seconds["render"] = perf_counter() - started - seconds["scene"]
    return job


def _tell(engine, warnings):
    for datablock, message, count in warnings:
        times = f" ({count} times)" if count > 1 else ""
        engine.report({"WARNING"}, f"{datablock}: {message}{times}")


def _deliver(engine, job, seconds, layer, origin):
    for tile in job.take_tiles(seconds):
        passes.deliver(engine, tile, layer.passes, layer.name, origin)
