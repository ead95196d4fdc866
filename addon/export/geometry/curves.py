# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves objects (hair) -> arrays."""

import numpy as np

from ..base.snapshot import Attribute
from .attributes import vectors
from .elements import (
    Elements,
    element_attributes,
    element_geometry,
    with_radii,
)

# What Cycles takes where there is no attribute.
_RADIUS = 0.005
_UV = "surface_uv_coordinate"


def read_curves(data, label, requested, report):
    """One geometry with one knot.

    Args:
        data: evaluated Curves.
        label: its name for messages, "curves 'Hair'".
        requested: names of generic attributes that materials ask for.
        report: called with (datablock, message).

    Returns:
        (Geometry, Elements), or None where there is no curve to see.
    """
    points, sizes = _read(None, data)
    if not (sizes > 1).any():
        return None
    if _any_set(data, "cyclic"):
        report(label, "its cyclic curves are left open")
    if _any_set(data, "curve_type", np.int32):
        report(label, "all its curves are taken for Catmull-Rom, as in Cycles before Blender 5")
    attributes = _surface_uv(data) + element_attributes(data, label, requested - {_UV}, report)
    geometry = element_geometry("CURVES", label, points, attributes, curve_sizes=sizes)
    return geometry, Elements(sizes, _read)


def _read(_thing, data):
    if not len(data.curves):
        # Blender holds one offset then and takes none.
        return np.empty((0, 4), dtype=np.float32), np.empty(0, dtype=np.int32)
    attribute = data.attributes.get("position")
    points = vectors(attribute.data if attribute else data.position_data)
    offsets = np.empty(len(data.curve_offset_data), dtype=np.int32)
    data.curve_offset_data.foreach_get("value", offsets)
    return with_radii(points, data, _RADIUS), np.diff(offsets)


def _any_set(data, name, dtype=np.bool_):
    attribute = data.attributes.get(name)
    if attribute is None:
        return False
    values = np.empty(len(attribute.data), dtype=dtype)
    attribute.data.foreach_get("value", values)
    return bool(values.any())


def _surface_uv(data):
    """Where each curve stands on the UV map of its surface: its UV, as in Cycles."""
    attribute = data.attributes.get(_UV)
    if attribute is None or attribute.domain != "CURVE":
        return []
    values = np.empty((len(attribute.data), 2), dtype=np.float32)
    attribute.data.foreach_get("vector", values.reshape(-1))
    return [Attribute(_UV, "FACE", "UV", values)]
