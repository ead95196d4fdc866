# SPDX-License-Identifier: GPL-3.0-or-later
"""Photometric files (IES LM-63) as tables over two angles, as forgiving as Cycles: whatever type and symmetry a file
has, angles become those of type C, around the axis and from straight down upwards."""

import bpy
import numpy as np

from ..base.regular_file import open_regular_file

# Watts of Cycles' lamps a candela: 4 pi over the 177.83 lm / W of illuminant D65.
_WATTS = 0.0706650768394
_TYPE_C, _TYPE_B, _TYPE_A = 1, 2, 3


def ies_table(node):
    """Properties of an IES Texture node.

    Returns:
        dict of float32: around [H] and up [V], radians, ascending; intensity [H * V].  Empty where there is no file,
        or none that can be read.
    """
    try:
        around, up, intensity = _completed(*_parsed(_text(node)))
    except (OSError, ValueError, IndexError):
        return {}
    table = {"around": np.radians(around), "up": np.radians(up), "intensity": intensity.ravel()}
    return {name: np.ascontiguousarray(v, dtype=np.float32) for name, v in table.items()}


def _text(node):
    if node.mode == "INTERNAL":
        return node.ies.as_string() if node.ies is not None else ""
    with open_regular_file(bpy.path.abspath(node.filepath), encoding="latin-1") as file:
        return file.read()


def _parsed(text):
    """(type, degrees around [H], degrees up [V], intensity [H, V]).  Raises ValueError or IndexError."""
    _, tilt, rest = text.replace(",", " ").partition("\nTILT=")
    if not tilt:
        raise ValueError("no TILT")
    if rest.startswith("INCLUDE"):
        tokens = rest.split()[1:]
        del tokens[: 2 + 2 * int(tokens[1])]
    else:
        tokens = rest.partition("\n")[2].split()
    ups, arounds, kind = (int(token) for token in tokens[3:6])
    if ups < 2 or arounds < 1 or kind not in (_TYPE_A, _TYPE_B, _TYPE_C):
        raise ValueError("no table")
    factor = _WATTS * float(tokens[2]) * float(tokens[10]) * float(tokens[11])
    numbers = np.array(tokens[13 : 13 + ups + arounds + ups * arounds], dtype=np.float64)
    up, around, intensity = np.split(numbers, [ups, ups + arounds])
    return kind, around, up, factor * intensity.reshape(arounds, ups)


def _completed(kind, around, up, intensity):
    """Type C's angles, with what symmetry leaves out."""
    if kind == _TYPE_B:  # its axis lies: the angles change their parts
        turned, rows = _about_90(up, intensity.T)
        up, columns = _about_90(around, rows.T)
        return turned, up, columns.T
    if kind == _TYPE_A:  # from -90 to 90, or half of it
        half = np.isclose(around[0], 0.0, atol=1e-4)
        mirrored = (180.0 + around[1:], intensity[1:]) if half else (around[:0], intensity[:0])
        around = np.concatenate([180.0 - around[::-1], mirrored[0]])
        return around, up + 90.0, np.concatenate([intensity[::-1], mirrored[1]])
    if np.isclose(around[0], 90.0, atol=1e-4):
        around = around - 90.0
    if len(around) == 1:
        return np.array([0.0, 360.0]), up, np.repeat(intensity, 2, axis=0)
    for end in (90.0, 180.0):  # a quarter, and then a half
        if np.isclose(around[-1], end, atol=1e-4):
            around = np.concatenate([around, 2.0 * end - around[-2::-1]])
            intensity = np.concatenate([intensity, intensity[-2::-1]])
    gap = 360.0 - around[-1]
    steps = around[-1] - around[-2], around[1] - around[0]
    if np.isclose(around[0], 0.0, atol=1e-4) and np.isclose(gap, steps, atol=1e-4).any():
        around = np.append(around, 360.0)
        intensity = np.concatenate([intensity, intensity[:1]])
    return around, up, intensity


def _about_90(angles, rows):
    """Angles from -90 to 90, or their upper half, counted from 0."""
    if not np.isclose(angles[0], 0.0, atol=1e-4):
        return angles + 90.0, rows
    return (
        np.concatenate([90.0 - angles[:0:-1], 90.0 + angles]),
        np.concatenate([rows[:0:-1], rows]),
    )
