# SPDX-License-Identifier: GPL-3.0-or-later
"""What a flip is about: only a warning that names it tells the artist of it."""

import bpy
from walk import find

# Shorter ones stand in any text.
_SHORTEST_WORD = 4


def names_of_flip(flip, roots):
    """Names that a new warning may tell of a flip by: of its datablocks and nodes.

    Args:
        flip: walk.Flip that has been applied.
        roots: of its probe.
    """
    if not flip.path:
        return names_of_roots(roots)
    found = set()
    for steps in range(1, len(flip.path) + 1):
        found |= _names_of(find(roots, flip.path[:steps]))
    if isinstance(flip.value, tuple) and flip.value[:1] == ("DATABLOCK",):
        found.add(_quoted(flip.value[1]))
    return found


def words_of_flip(flip, roots):
    """Words that any warning may tell of a flip by: of the property itself."""
    if not flip.path:
        return _words(flip.name.removeprefix("output "))
    struct = find(roots, flip.path)
    words = _words(flip.name) | _words(struct.bl_rna.properties[flip.name].name)
    if isinstance(struct, bpy.types.NodeSocket):
        # "Sheen Weight" is one of sheen's.
        words = _words(struct.identifier) | _words(struct.name.split(" ")[0])
    return words


def names_of_roots(roots):
    """The same of all that a probe shows."""
    return set().union(*(_names_of(root) for root in roots.values()))


def tells(text, names):
    """Whether a message names one of these."""
    return any(name in text or name in text.lower() for name in names)


def _names_of(struct):
    """Of a struct, of the datablock that it is part of, and of what uses that one."""
    owner = getattr(struct, "id_data", None)
    found = {_quoted(name) for name in _own_names(struct)}
    if owner is None:
        return found
    found |= {_quoted(name) for name in _own_names(owner)}
    found |= {_quoted(thing.name) for thing in bpy.data.objects if thing.data == owner}
    for blocks in (bpy.data.materials, bpy.data.worlds, bpy.data.lights):
        found |= {_quoted(block.name) for block in blocks if block.node_tree == owner}
    return found


def _own_names(struct):
    name = getattr(struct, "name", None)
    return [name] if isinstance(name, str) and name else []


def _quoted(name):
    return f"'{name}'"


def _words(name):
    """ "use_pass_mist" and "Use Pass Mist" -> "use pass mist"."""
    plain = name.replace("_", " ").lower()
    return {plain} if len(plain) >= _SHORTEST_WORD else set()
