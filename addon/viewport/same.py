# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether two snapshots are the same frame: Blender tells of edits, also of those that no picture shows."""

import numpy as np


def is_same(a, b):
    """Of dicts, lists, arrays and plain values, deep."""
    if a is b:
        return True
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return _same_arrays(a, b)
    if type(a) is not type(b):
        return False
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(is_same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(is_same, a, b))
    return bool(a == b)


def _same_arrays(a, b):
    if not (isinstance(a, np.ndarray) and isinstance(b, np.ndarray)):
        return False
    if a.dtype != b.dtype or a.shape != b.shape:
        return False
    # By bytes: what is no number is the same as itself.
    return np.ascontiguousarray(a).tobytes() == np.ascontiguousarray(b).tobytes()
