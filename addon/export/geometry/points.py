# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds -> arrays."""

import numpy as np

from ..base.snapshot import Geometry
from .elements import Elements, element_attributes, split_radii, vector_attribute, with_radii

# What Cycles takes where there is no attribute.
_RADIUS = 0.01


def read_point_cloud(data, label, requested, report):
    """One geometry with one knot.

    Args:
        data: evaluated PointCloud.
        label: its name for messages.
        requested: names of generic attributes that materials ask for.
        report: called with (datablock, message).

    Returns:
        (Geometry, Elements), or None where there is no point.
    """
    points, sizes = _read(None, data)
    if len(points) == 0:
        return None
    places, radii = split_radii(points[None])
    geometry = Geometry(
        name=label,
        kind="POINTS",
        points=places,
        radius=radii,
        attributes=element_attributes(data, label, requested, report),
    )
    return geometry, Elements(sizes, _read)


def _read(_thing, data):
    attribute = data.attributes.get("position")
    points = vector_attribute(attribute.data) if attribute else vector_attribute(data.points, "co")
    return with_radii(points, data, _RADIUS), np.array([len(points)], dtype=np.int32)
