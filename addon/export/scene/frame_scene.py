# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene at Blender's frame, as the other times of the shutter are held against it."""

from dataclasses import dataclass, field, replace

import numpy as np

from ..base.identity import distinct
from .depsgraph import Visit
from .plain_objects import PlainObjects

# Of what is flat, over its width.
_LEAST_HEIGHT = 0.1


@dataclass
class FrameScene:
    depsgraph: object  # evaluated
    viewpoint: object  # of viewpoint.py
    camera_record: dict  # its record at the frame
    visit: Visit
    plain: PlainObjects
    sources: list  # of geometry.GeometrySource
    geometry_of_prototype: np.ndarray  # int32 [prototypes], -1 = none
    is_light: np.ndarray  # bool [prototypes]
    energies: dict  # of lamps.energies
    lamp_graphs: dict  # of lamps.lamp_graphs
    again: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))  # of come_again
    _bounds: tuple = None

    def come_again(self, things):
        """Adds things to the visit, at its end, that are others of it at another time: int [c]."""
        self.again = things
        if len(things):
            more = self.visit.with_more(self.visit, things, self.visit.prototype[things])
            self.visit = replace(more, identity=distinct(more.identity))

    def cages(self):
        """{address of an original Object: subdivision.Cage}."""
        return {
            prototype.address: prototype.cage
            for prototype in self.visit.prototypes
            if prototype.cage is not None
        }

    def things_of(self, geometry):
        """int [m], indices in the visit."""
        return np.flatnonzero(self.geometry_of_prototype[self.visit.prototype] == geometry)

    def is_seen(self):
        """bool [n]: has a geometry or shines."""
        prototype = self.visit.prototype
        return (self.geometry_of_prototype[prototype] >= 0) | self.is_light[prototype]

    def bounds(self, things):
        """(float64 [m, 4] centers, float64 [m, 3] half sizes) of boxes in object space: of points with their
        radii.  A light is as wide as 1 m, and what is flat a tenth as high as wide, as it may be displaced."""
        if self._bounds is None:
            # Row by row: along columns NumPy takes five times as long.
            rows = (source.geometry.points[0].T.copy() for source in self.sources)
            boxes = [(row.min(axis=1), row.max(axis=1)) for row in rows]
            boxes = np.array([*boxes, ((-0.5,) * 3, (0.5,) * 3)], dtype=np.float64)
            centers = np.ones((len(boxes), 4))
            centers[:, :3] = boxes.mean(axis=1)
            half = (boxes[:, 1] - boxes[:, 0]) / 2.0
            half = np.maximum(half, _LEAST_HEIGHT * half.max(axis=1, keepdims=True))
            for i, source in enumerate(self.sources):
                if source.geometry.radius is not None:
                    half[i] += np.max(source.geometry.radius[0], initial=0.0)
            self._bounds = centers, half
        geometry = self.geometry_of_prototype[self.visit.prototype[things]]
        return self._bounds[0][geometry], self._bounds[1][geometry]
