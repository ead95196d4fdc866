# SPDX-License-Identifier: GPL-3.0-or-later
"""What a change of time touched of the objects that stand for themselves, so that the rest is not read again.

Most steps move a few of these.  Anything that might make or be an instance ends the short way: the
scene is then walked anew.
"""

from dataclasses import dataclass, field

import numpy as np

from ..base.transforms import from_matrix
from ..base.updates import object_names, originals

# Objects that are no things of a visit and can neither make nor be one.
_NEVER_SEEN = {"ARMATURE", "CAMERA", "EMPTY", "LATTICE", "LIGHT_PROBE", "SPEAKER"}


@dataclass
class Changes:
    """Objects of a visit that were touched since the last time; all stand for themselves."""

    moved: list = field(default_factory=list)  # things
    matrices: list = field(default_factory=list)  # float64 [4, 4] of these, world from object
    objects: dict = field(default_factory=dict)  # thing -> evaluated Object with other geometry


class PlainObjects:
    """Which objects of a visit stand for themselves, with their hair, and nothing else stands for them."""

    def __init__(self, scan, view_layer):
        self.names = object_names()
        self.seen = {prototype.name for prototype in scan.prototypes} & set(self.names)
        makers = {
            prototype.parent_address for prototype in scan.prototypes if prototype.parent_address
        }
        if makers:
            self.seen |= {thing.name for pointer, thing in originals().items() if pointer in makers}
        self._linked = self.seen & set(view_layer.objects.keys())
        self._missed = set()
        self.unlinked = set()  # names of what left the view layer since
        first = np.full(len(scan.prototypes), -1)
        first[scan.prototype[::-1]] = np.arange(len(scan.prototype))[::-1]
        many = np.bincount(scan.prototype, minlength=len(scan.prototypes)) != 1
        self._things, self.entangled = {}, set()
        for index, prototype in enumerate(scan.prototypes):
            if prototype.parent_address:
                self.entangled.add(prototype.parent_address)
            things = self._things.setdefault(prototype.address, [])
            another = len(things) > 0 and prototype.type != "HAIR"
            if many[index] or scan.is_instance[first[index]] or another:
                self.entangled.add(prototype.address)
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
            updates: of `read_updates`.
        """
        from bpy.types import Collection, Object

        if object_names() != self.names:
            return None
        found = Changes()
        for thing, moved, formed, _ in updates:
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
