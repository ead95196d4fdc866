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

    moved: list = field(default_factory=list)  # things
    matrices: list = field(default_factory=list)  # float64 [4, 4] of these, world from object
    objects: dict = field(default_factory=dict)  # thing -> evaluated Object with other geometry


class Plain:
    """Which objects of a visit stand for themselves, with their hair, and nothing else stands for them."""

    def __init__(self, scan, view_layer):
        self.names = object_names()
        self.seen = {kind.name for kind in scan.kinds} & set(self.names)
        makers = {kind.parent_address for kind in scan.kinds if kind.parent_address}
        if makers:
            self.seen |= {thing.name for pointer, thing in originals().items() if pointer in makers}
        self._linked = self.seen & set(view_layer.objects.keys())
        self._missed = set()
        self.unlinked = set()  # names of what left the view layer since
        first = np.full(len(scan.kinds), -1)
        first[scan.kind[::-1]] = np.arange(len(scan.kind))[::-1]
        many = np.bincount(scan.kind, minlength=len(scan.kinds)) != 1
        self._things, self.entangled = {}, set()
        for index, kind in enumerate(scan.kinds):
            if kind.parent_address:
                self.entangled.add(kind.parent_address)
            things = self._things.setdefault(kind.address, [])
            another = len(things) > 0 and kind.type != "HAIR"
            if many[index] or scan.is_instance[first[index]] or another:
                self.entangled.add(kind.address)
            things.append(int(first[index]))

    def gone(self, view_layer):
        """[(name, what was done to it)] of what is not there any more, each once: handlers of other add-ons
        delete, rename and unlink.  What left the view layer is not evaluated any more."""
        here = object_names()
        missing = set() if here == self.names else self.seen - set(here) - self._missed
        self._missed |= missing
        unlinked = self._linked - set(view_layer.objects.keys()) - self._missed - self.unlinked
        self.unlinked |= unlinked
        return [(name, "was deleted or renamed") for name in sorted(missing)] + [
            (name, "was unlinked") for name in sorted(unlinked)
        ]

    def changes(self, updates):
        """Changes of the last step, or None where only a walk can tell.

        Args:
            updates: of `last_updates`.
        """
        from bpy.types import Collection, Object

        if object_names() != self.names:
            return None
        found = Changes()
        for thing, moved, formed in updates:
            if not (moved or formed):
                continue
            if isinstance(thing, Collection):
                return None
            if not isinstance(thing, Object):
                continue  # an object that uses it is named as well
            things = self.things_of(thing)
            if things is None:
                return None
            if moved and things:
                found.moved += things
                found.matrices += [from_matrix(thing.matrix_world)] * len(things)
            if formed:
                found.objects |= dict.fromkeys(things, thing)
        return found

    def things_of(self, thing):
        """Where an evaluated Object and its hair are in the visit, indices; none where there is nothing to see,
        None where only a walk can tell."""
        pointer = thing.original.as_pointer()
        if pointer in self.entangled or thing.is_instancer:
            return None
        things = self._things.get(pointer)
        if things is None:
            return [] if thing.type in _NEVER_SEEN else None
        return None if thing.hide_render else things


class Touched:
    """Everything that updates of the depsgraph named since it was made; by address of the original."""

    def __init__(self):
        self.moved, self.formed = set(), set()
        self.otherwise = set()  # objects of which something else changed
        self.collections = False

    def add(self, depsgraph):
        """What the last evaluation touched."""
        import bpy

        for update in depsgraph.updates:
            moved, formed = update.is_updated_transform, update.is_updated_geometry
            pointer = update.id.original.as_pointer()
            if moved:
                self.moved.add(pointer)
            if formed:
                self.formed.add(pointer)
            if isinstance(update.id, bpy.types.Collection):
                self.collections = True
            if not (moved or formed) and isinstance(update.id, bpy.types.Object):
                self.otherwise.add(pointer)


def originals():
    """{address: original Object}, of the whole file."""
    import bpy

    return {thing.as_pointer(): thing for thing in bpy.data.objects}


def object_names():
    """All objects of the file: another list means that something was made, deleted or renamed."""
    import bpy

    return bpy.data.objects.keys()


def last_updates(depsgraph):
    """[(evaluated ID, whether it moved, whether its geometry changed)] of the last evaluation, read once: each look
    at them costs a microsecond a thing."""
    return [(u.id, u.is_updated_transform, u.is_updated_geometry) for u in depsgraph.updates]


def lights_changed(updates):
    """Whether the last step touched any light or nodes."""
    from bpy.types import Light, NodeTree

    return any(isinstance(thing, (Light, NodeTree)) for thing, _, _ in updates)


def changed_geometry(updates):
    """Addresses of the original datablocks whose geometry the last step touched."""
    return {thing.original.as_pointer() for thing, _, formed in updates if formed}
