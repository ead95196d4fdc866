# SPDX-License-Identifier: GPL-3.0-or-later
"""What a name means on a datablock, as attributes of shaders and drivers understand names."""


def find_value(struct, name):
    """A custom property, else what a path of RNA leads to: four floats; None where it is no one to four numbers."""
    try:
        value = struct[name] if name in struct.keys() else struct.path_resolve(name)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError):
        return None
    if isinstance(value, (bool, int, float)):
        return (float(value),) * 3 + (1.0,)
    if isinstance(value, (str, set)) or not hasattr(value, "__len__") or not 1 <= len(value) <= 4:
        return None
    try:
        numbers = [float(x) for x in value]
    except (TypeError, ValueError):
        return None
    return tuple(numbers + [0.0, 0.0, 0.0, 1.0][len(numbers) :])
