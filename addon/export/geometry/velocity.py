# SPDX-License-Identifier: GPL-3.0-or-later
"""The point attribute `velocity`: motion that a simulation knows, whatever becomes of its topology.

Units a second in object space, as fluids, Alembic, USD and geometry nodes write it.  Where it exists
it says all of the deformation, as in Cycles; the object's own motion comes on top.
"""

import numpy as np

from ..base.report import counted
from .attributes import vectors

NAME = "velocity"


def read_velocity(data, count, label, report):
    """float32 [V, 3] metres a second, or None.

    Args:
        data: evaluated Mesh, Curves or PointCloud.
        count: of its points.
        label: its name for messages.
        report: called with (datablock, message).
    """
    attribute = data.attributes.get(NAME)
    if attribute is None:
        return None
    if attribute.domain != "POINT" or attribute.data_type != "FLOAT_VECTOR":
        report(
            label,
            f"attribute '{NAME}' ({attribute.data_type} on {attribute.domain}) is not used: motion "
            "wants vectors on points",
        )
        return None
    if len(attribute.data) != count:
        report(label, f"its '{NAME}' has {len(attribute.data)} values for {count} points: not used")
        return None
    return finite_velocity(attribute, "point", label, report)


def finite_velocity(attribute, noun, label, report):
    """float32 [n, 3] of an attribute of vectors; what is not finite is 0 and named, by the noun for one of n."""
    velocity = vectors(attribute.data)
    broken = ~np.isfinite(velocity).all(axis=1)
    if broken.any():
        count = counted(np.count_nonzero(broken), noun)
        report(label, f"its '{NAME}' is not finite at {count}, taken as 0")
        velocity[broken] = 0.0
    return velocity


def points_by_velocity(sources, shutter, frames_per_second):
    """{geometry index: float32 [2, V, 3]} of the GeometrySources whose points say their velocity."""
    return {
        index: moved_points(source.geometry.points[0], source.velocity, shutter, frames_per_second)
        for index, source in enumerate(sources)
        if source.velocity is not None and source.velocity.any()
    }


def moved_points(points, velocity, shutter, frames_per_second):
    """float32 [2, V, 3]: where points are when the shutter opens and when it closes.

    Args:
        points: float32 [V, 3] at the frame.
        velocity: float32 [V, 3], metres a second.
        shutter: shutter.Shutter.
        frames_per_second: fps / fps_base.
    """
    seconds = shutter.length / frames_per_second
    times = np.array([-shutter.frame_time, 1.0 - shutter.frame_time]) * seconds
    ends = points + times[:, None, None] * velocity.astype(np.float64)
    return ends.astype(np.float32)
