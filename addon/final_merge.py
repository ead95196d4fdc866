# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer of one final frame, joined from parts that others have rendered.

Nothing is exported and nothing rendered; what follows in Blender is what follows a render.
"""

from types import SimpleNamespace

from . import passes
from .event_log import EventLog
from .export.base.report import Cancelled
from .export.scene.options import rendered_frame, scene_crop
from .parts.joined_parts import read_parts
from .parts.part_output import folder_of
from .properties import TILE_PIXELS
from .status_line import StatusLine, layers_done


class FinalMerge:
    """Lives for one call of the engine's `render()`.  `run` raises Cancelled, or PartError."""

    def __init__(self, engine, depsgraph, options):
        """`options`: of the command line."""
        self.engine = engine
        self.options = options
        self.scene = depsgraph.scene
        self.layer = depsgraph.view_layer.name
        log = EventLog(options.log, self.scene.frame_current, self.layer)
        self.status = StatusLine(engine, log, *layers_done(engine, depsgraph))
        self.passes = passes.wanted(depsgraph.view_layer)
        self.exposure = passes.exposure_owner(depsgraph.scene_eval).film_exposure

    def run(self):
        crop = scene_crop(self.scene, rendered_frame(self.engine, self.scene.render))
        count = self.options.merge
        parts = read_parts(
            folder_of(self.options, self.scene.render.filepath),
            self.scene.frame_current,
            self.layer,
            count,
            crop,
            TILE_PIXELS,
            [(p.native, p.channels) for p in self.passes],
        )
        for number, part in enumerate(parts, 1):
            if self.engine.is_cancelled():
                raise Cancelled
            passes.deliver(
                self.engine, _tile(part), self.passes, self.layer, crop[:2], self.exposure
            )
            self.status.joining(number, count)
        self.status.rendered()


def _tile(part):
    """As the native library hands tiles over."""
    x, y = part.header["rect"][:2]
    return SimpleNamespace(
        x=x, y=y, combined=part.passes["Combined"], depth=None, passes=part.passes
    )
