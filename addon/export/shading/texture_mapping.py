# SPDX-License-Identifier: GPL-3.0-or-later
"""A texture node's own mapping, which moves its coordinates without a Mapping node: files and scripts from before
Blender 2.8 have it."""

import numpy as np

# Of a scale that is inverted (Cycles).
_LEAST_SCALE = 1e-5
_AXES = ("X", "Y", "Z")


def is_unmoved(mapping):
    """Of a TexMapping, by what Cycles reads of it."""
    moved = any(mapping.translation) or any(mapping.rotation) or tuple(mapping.scale) != (1, 1, 1)
    axes = mapping.mapping_x, mapping.mapping_y, mapping.mapping_z
    return not moved and axes == _AXES


def mapping_rows(mapping):
    """Rows of the matrix that moves coordinates of a TexMapping: float32 [12]."""
    from mathutils import Euler

    scale, kind = np.array(mapping.scale, dtype=np.float64), mapping.vector_type
    if kind in {"TEXTURE", "NORMAL"}:
        scale = np.where(np.abs(scale) < _LEAST_SCALE, np.copysign(_LEAST_SCALE, scale), scale)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(Euler(mapping.rotation, "XYZ").to_matrix()) * scale
    if kind in {"TEXTURE", "POINT"}:
        matrix[:3, 3] = mapping.translation
    if kind == "TEXTURE":
        matrix = np.linalg.inv(matrix)
    if kind == "NORMAL":
        matrix = np.linalg.inv(matrix).T
    picked = np.zeros((4, 4))
    picked[3, 3] = 1.0
    for row, axis in enumerate((mapping.mapping_x, mapping.mapping_y, mapping.mapping_z)):
        if axis in _AXES:
            picked[row, _AXES.index(axis)] = 1.0
    return (matrix @ picked)[:3].astype(np.float32).ravel()
