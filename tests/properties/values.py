# SPDX-License-Identifier: GPL-3.0-or-later
"""The other values of an RNA property: each item of an enum, the other state of a switch, both ends of a range, a
name that nothing has.

Soft limits are the ends, as sliders have them.  An end that lies further off than the value itself (or 1,
or 40 degrees) is replaced by a value at that distance: a sphere of 10,000 metres shows nothing of itself.
"""

import math

import bpy

_REACH_OF_ANGLES = 0.7
# Cycles 3.4 ends Blender where something that moves is scaled to nothing, and takes hours for hair a metre thick.
_REACHES = {"scale": 0.5, "delta_scale": 0.5, "radius_scale": 0.009}


def other_values(struct, rna):
    """Values of a property that it does not have now.

    Args:
        struct: bpy_struct.
        rna: one of the properties of its bl_rna.

    Returns:
        list of (text, value); text is the same in every run.
    """
    kind = rna.type
    if kind == "POINTER":
        return _other_datablocks(struct, rna)
    now = getattr(struct, rna.identifier)
    if kind == "ENUM":
        return _other_items(rna, now)
    if kind == "STRING":
        return _other_strings(now)
    if kind not in ("BOOLEAN", "INT", "FLOAT"):
        return []
    if getattr(rna, "is_array", False):
        return _other_arrays(rna, now)
    return [(_text(value), value) for value in _other_numbers(rna, now)]


def _other_items(rna, now):
    items = [item.identifier for item in rna.enum_items]
    if rna.is_enum_flag:
        choices = [set(), set(items)]
        return [("+".join(sorted(choice)) or "none", choice) for choice in choices if choice != now]
    return [(item, item) for item in items if item and item != now]


def _other_strings(now):
    """A name that nothing has, and none."""
    return [("'Elsewhere'", "Elsewhere"), *([("''", "")] if now else [])]


def _other_numbers(rna, now):
    if rna.type == "BOOLEAN":
        return [not now]
    reach = _REACH_OF_ANGLES if rna.subtype == "ANGLE" else max(1.0, abs(now))
    reach = _REACHES.get(rna.identifier, reach)
    ends = max(rna.soft_min, now - reach), min(rna.soft_max, now + reach)
    if rna.subtype == "FACTOR" and 0.0 <= now <= 1.0:
        ends = max(ends[0], 0.0), min(ends[1], 1.0)
    if rna.type == "INT":
        ends = [int(end) for end in ends]
    return [end for end in ends if not math.isclose(end, now, rel_tol=1e-6, abs_tol=1e-9)]


def _other_arrays(rna, now):
    """The first component at one end, the last at the other: a swap of components shows."""
    try:
        flat = list(now)
        if not flat or hasattr(flat[0], "__len__"):
            return []
    except TypeError:
        return []
    found = []
    for place in sorted({0, len(flat) - 1}):
        for value in _other_numbers(rna, flat[place])[: 1 if place else 2]:
            changed = list(flat)
            changed[place] = value
            found.append((f"[{place}] {_text(value)}", changed))
    return found


def _other_datablocks(struct, rna):
    """None, and the first other datablock of its type."""
    if rna.is_readonly or not issubclass(_class(rna.fixed_type), bpy.types.ID):
        return []
    now = getattr(struct, rna.identifier)
    found = [] if now is None or rna.is_never_none else [("None", None)]
    for datablock in _datablocks(rna.fixed_type.identifier):
        if datablock != now and datablock != struct:
            return [*found, (f"'{datablock.name}'", ("DATABLOCK", datablock.name))]
    return found


def _class(rna_type):
    return getattr(bpy.types, rna_type.identifier, object)


def _datablocks(type_name):
    for collection in bpy.data.bl_rna.properties:
        if collection.type == "COLLECTION" and collection.fixed_type.identifier == type_name:
            return sorted(getattr(bpy.data, collection.identifier), key=lambda block: block.name)
    return []


def assign(struct, rna_name, value):
    """Sets a property to a value of `other_values`; whether it has it then."""
    if isinstance(value, tuple) and value and value[0] == "DATABLOCK":
        fixed = struct.bl_rna.properties[rna_name].fixed_type.identifier
        value = next(block for block in _datablocks(fixed) if block.name == value[1])
    before = _plain(getattr(struct, rna_name))
    try:
        setattr(struct, rna_name, value)
    except (TypeError, ValueError, AttributeError, RuntimeError):
        return False
    return _plain(getattr(struct, rna_name)) != before


def _plain(value):
    return list(value) if hasattr(value, "__len__") and not isinstance(value, (str, set)) else value


def _text(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)
