# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds -> arrays."""

import numpy as np

from .attributes import vectors
from .elements import (
    Elements,
    element_attributes,
    element_geometry,
    with_radii,
)

# What Cycles takes where there is no attribute.
_RADIUS = 0.01


def read_point_cloud(data, label, requested, report):
    """The same as `curves.read_curves` of an evaluated PointCloud; None where there is no point."""
    points, sizes = _read(None, data)
    if len(points) == 0:
        return None
    attributes = element_attributes(data, label, requested, report)
    return element_geometry("POINTS", label, points, attributes), Elements(sizes, _read)


def _read(_thing, data):
    attribute = data.attributes.get("position")
    points = vectors(attribute.data) if attribute else vectors(data.points, "co")
    return with_radii(points, data, _RADIUS), np.array([len(points)], dtype=np.int32)
