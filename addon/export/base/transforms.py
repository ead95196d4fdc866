# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's matrices in the snapshot's convention.

Both are right-handed with column vectors, `m[row, column]`.  Blender's are float32; the snapshot's
are float64, so that nothing is lost when camera-from-object is composed.  Blender's camera looks
along its -z; the snapshot's looks along +z.
"""

import numpy as np


def from_matrix(matrix):
    """mathutils.Matrix -> float64 [4, 4]."""
    return np.array([list(row) for row in matrix], dtype=np.float64)


def world_from_camera(matrix_world):
    """Camera matrix without scale, z forward.

    Args:
        matrix_world: [4, 4] of the camera object.

    Returns:
        float64 [4, 4].  Axes keep their directions, each with unit length, as Blender itself reads
        a scaled or sheared camera.  An axis of length 0 gives None: there is nothing to see through.
    """
    matrix = np.array(matrix_world, dtype=np.float64)
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if not np.isfinite(matrix).all() or (lengths <= 0.0).any():
        return None
    matrix[:3, :3] /= lengths
    matrix[:3, 2] *= -1.0
    return matrix


def inverse(matrix):
    """float64 [4, 4], the inverse of an affine one.

    By hand: for one small matrix NumPy's wakes LAPACK's threads, which costs milliseconds.
    """
    x, y, z, origin = matrix[:3].T
    rows = np.array([_cross(y, z), _cross(z, x), _cross(x, y)])
    rows /= x @ rows[0]
    found = np.eye(4)
    found[:3, :3] = rows
    found[:3, 3] = -rows @ origin
    return found


def volume(matrix):
    """Of the image of the unit cube under [4, 4], signed."""
    x, y, z = matrix[:3, :3].T
    return x @ _cross(y, z)


def _cross(a, b):
    """As np.cross of two vectors, which takes ten times as long (40 microseconds)."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def is_finite(matrices):
    """bool [n] of [n, 4, 4]."""
    return np.isfinite(matrices).all(axis=(1, 2))


def has_area(matrices):
    """bool [n] of [n, 4, 4]: false where everything shrinks to a line or a point."""
    axes = matrices[:, :3, :3]
    x, y, z = axes[:, :, 0], axes[:, :, 1], axes[:, :, 2]
    return np.cross(x, y).any(axis=1) | np.cross(y, z).any(axis=1) | np.cross(z, x).any(axis=1)
