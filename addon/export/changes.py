# SPDX-License-Identifier: GPL-3.0-or-later
"""What a change of time touched, from `depsgraph.updates`, so that the rest is not read again.

Most steps move a few objects that stand for themselves.  Anything that might make or be an instance
ends the short way: the scene is then walked anew.  Only what `updates` itself holds is asked, so a
handler that deleted an object meanwhile leaves no dangling reference.
"""

from dataclasses import dataclass, field

import numpy as np

from .transforms import from_matrix

# Objects that are no things of a visit and can neither make nor be one.
_NEVER_SEEN = {"ARMATURE", "CAMERA", "EMPTY", "LATTICE", "LIGHT_PROBE", "SPEAKER"}


@dataclass
class Changes:
    """Objects of a visit that were touched since the last time; all stand for themselves."""

    places: dict = field(default_factory=dict)  # thing -> float64 [4, 4], world from object
    objects: dict = field(default_factory=dict)  # thing -> evaluated Object with other geometry


class Plain:
    """Which objects of a visit stand for themselves, and nothing else stands for them."""

    def __init__(self, scan):
        self.names = object_names()
        first = np.full(len(scan.kinds), -1)
        first[scan.kind[::-1]] = np.arange(len(scan.kind))[::-1]
        many = np.bincount(scan.kind, minlength=len(scan.kinds)) != 1
        self.thing, self.entangled = {}, set()
        for index, kind in enumerate(scan.kinds):
            pointer = kind.source.original.as_pointer()
            if kind.parent is not None:
                self.entangled.add(kind.parent.original.as_pointer())
            if many[index] or scan.is_instance[first[index]] or pointer in self.thing:
                self.entangled.add(pointer)
            self.thing[pointer] = int(first[index])

    def changes(self, depsgraph):
        """Changes of the last step, or None where only a walk can tell."""
        import bpy

        if object_names() != self.names:
            return None
        found = Changes()
        for update in depsgraph.updates:
            moved, formed = update.is_updated_transform, update.is_updated_geometry
            if not (moved or formed):
                continue
            thing = update.id
            if isinstance(thing, bpy.types.Collection):
                return None
            if not isinstance(thing, bpy.types.Object):
                continue  # an object that uses it is named as well
            pointer = thing.original.as_pointer()
            if pointer in self.entangled or thing.is_instancer:
                return None
            index = self.thing.get(pointer)
            if index is None:
                if thing.type in _NEVER_SEEN:
                    continue
                return None
            if thing.hide_render:
                return None
            if moved:
                found.places[index] = from_matrix(thing.matrix_world)
            if formed:
                found.objects[index] = thing
        return found


def object_names():
    """All objects of the file: another list means that something was made, deleted or renamed."""
    import bpy

    return bpy.data.objects.keys()


def moved(depsgraph):
    """Whether the last step touched any place or geometry."""
    return any(
        update.is_updated_transform or update.is_updated_geometry for update in depsgraph.updates
    )


def changed_geometry(depsgraph):
    """Addresses of the original datablocks whose geometry the last step touched."""
    return {
        update.id.original.as_pointer()
        for update in depsgraph.updates
        if update.is_updated_geometry
    }
