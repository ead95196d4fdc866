# SPDX-License-Identifier: GPL-3.0-or-later
"""What scene-linear colours stand for: linear Rec. 709 in Blender's own configuration of OpenColorIO, but a file of
Blender 5 may have another working space, and a studio another configuration."""

import numpy as np

# Y of linear Rec. 709, as Cycles has it.
_LUMINANCE = np.array([0.2126729, 0.7151522, 0.0721750])
# What single precision and inverted matrices leave of a space that is the same.
_SAME = 1e-4


def scene_from_rec709():
    """float64 [3,3]: scene-linear colours = the matrix times those of linear Rec. 709.  The identity, exactly, where
    they are the same."""
    from mathutils import Color

    columns = [Color(axis).from_rec709_linear_to_scene_linear() for axis in np.eye(3).tolist()]
    matrix = np.array(columns, dtype=np.float64).T
    return np.eye(3) if np.allclose(matrix, np.eye(3), rtol=0, atol=_SAME) else matrix


def scene_color(rec709):
    """Scene-linear, nothing below 0, of colours [..., 3] of linear Rec. 709."""
    return np.maximum(np.asarray(rec709) @ scene_from_rec709().T, 0.0)


def luminance():
    """float64 [3]: of the primaries."""
    return _LUMINANCE @ np.linalg.inv(scene_from_rec709())


def working_space():
    """The snapshot's record; None where colours are those of linear Rec. 709."""
    matrix = scene_from_rec709()
    if np.array_equal(matrix, np.eye(3)):
        return None
    return {"from_rec709": matrix.astype(np.float32), "luminance": luminance().astype(np.float32)}
