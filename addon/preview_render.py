# SPDX-License-Identifier: GPL-3.0-or-later
"""Previews of materials, lights, worlds and textures: Blender's own small scenes, one picture each.

They live in a file of Blender's own, so what is looked up in the artist's is not there.
"""

from . import bridge, passes
from .export import export_frame
from .export.base.report import Cancelled, Report
from .final_render import POLL_SECONDS


class _Settings:
    """In place of `scene.granita`.  Glass shows what is behind it; icons are as large as a fingernail."""

    samples = 16
    light_samples = 4
    bounces = "FAST"
    device = "CPU"


def render_preview(engine, depsgraph):
    """Renders into the engine's result.  What there is to warn of is said of frames.

    Raises:
        Cancelled, ExportError, and what bridge.rendering raises.
    """
    layer = depsgraph.view_layer.name
    snapshot = export_frame(
        engine, depsgraph, _Settings, Report(), lambda _wanted: engine.is_cancelled()
    )
    combined = passes.PASSES[:1]
    origin = [int(pixel) for pixel in snapshot["options"]["crop"][:2]]
    with bridge.rendering(snapshot, "a preview") as job:
        while not job.done():
            _deliver(engine, job.take_tiles(POLL_SECONDS), combined, layer, origin)
            if engine.is_cancelled():
                raise Cancelled
        _deliver(engine, job.take_tiles(0.0), combined, layer, origin)


def _deliver(engine, tiles, combined, layer, origin):
    for tile in tiles:
        passes.deliver(engine, tile, combined, layer, origin)
