# SPDX-License-Identifier: GPL-3.0-or-later
"""What curves, hair and point clouds share: what must stay for their deformation to be motion, and
their attributes."""

from dataclasses import dataclass

import numpy as np

from ..base.snapshot import Attribute, Geometry
from .attributes import finite_attributes, shadable

# Blender's domain -> the snapshot's.
_DOMAINS = {"POINT": "POINT", "CURVE": "FACE"}


@dataclass(frozen=True)
class Elements:
    """How many points each element has; `read(thing, data)` gives its points at another time: their
    places, and their radii too where these may change."""

    sizes: np.ndarray  # int32 [elements]
    read: object  # function of (evaluated Object, its data) -> (float32 [V, 3 or 4], int32 sizes)

    def points_again(self, thing, data):
        """float32 [V, 3 or 4], or None where the elements are not the frame's any more."""
        points, sizes = self.read(thing, data)
        return points if np.array_equal(sizes, self.sizes) else None


def with_radii(points, data, default):
    """float32 [V, 4]: places and radii, metres, object space.

    Args:
        points: float32 [V, 3].
        data: evaluated Curves or PointCloud.
        default: where it has no attribute `radius`.
    """
    attribute = data.attributes.get("radius")
    radii = np.full((len(points), 1), default, dtype=np.float32)
    if attribute is not None and attribute.domain == "POINT" and attribute.data_type == "FLOAT":
        attribute.data.foreach_get("value", radii.reshape(-1))
    return np.hstack([points, radii])


def split_radii(knots):
    """(places float32 [K, V, 3], radii float32 [K, V]) of float32 [K, V, 4]."""
    return np.ascontiguousarray(knots[..., :3]), np.ascontiguousarray(knots[..., 3])


def element_geometry(kind, label, points, attributes, **columns):
    """A Geometry of one knot.

    Args:
        kind: "CURVES" or "POINTS".
        label: its name for messages.
        points: float32 [V, 4], of `with_radii`.
        attributes: of `element_attributes`.
        columns: what else it has.
    """
    places, radii = split_radii(points[None])
    return Geometry(
        name=label, kind=kind, points=places, radius=radii, attributes=attributes, **columns
    )


def element_attributes(data, label, requested, report):
    """The generic attributes asked for, on points or elements.

    Args:
        data: evaluated Curves or PointCloud.
        label: its name for messages.
        requested: names.
        report: called with (datablock, message).
    """
    found = []
    for attribute, domain, values in shadable(data, requested, _DOMAINS, label, report):
        color = attribute.data_type in {"FLOAT_COLOR", "BYTE_COLOR"}
        found.append(Attribute(attribute.name, domain, "COLOR" if color else "GENERIC", values))
    finite_attributes(found, label, report)
    return found
