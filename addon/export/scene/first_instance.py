# SPDX-License-Identifier: GPL-3.0-or-later
"""The first element of `depsgraph.object_instances` where that is the only thing an instancer shows.

Python's iterators step on before they give an element away, and Blender frees an instancer's list when it steps past its
last one.  Of later elements it keeps a copy for that, of the first it does not (3.4 to 5.0): what is read of it then is
another object's place, or crashes.  An instancer that is not shown itself is enough, as linked collections often are.
"""

from collections import deque
from functools import cached_property

import numpy as np

_LEVELS = 8  # of a persistent id


class FirstInstance:
    """Stands in for it: a DepsgraphObjectInstance of which nothing is read from its list."""

    is_instance = True

    def __init__(self, instance, depsgraph):
        self._depsgraph = depsgraph
        self.object, self.parent = instance.object, instance.parent
        self.show_self, self.show_particles = instance.show_self, instance.show_particles

    @property
    def instance_object(self):
        return self.object.original.evaluated_get(self._depsgraph)

    @property
    def matrix_world(self):
        return self.object.matrix_world

    @cached_property
    def persistent_id(self):
        return self._read("persistent_id", _LEVELS, np.int32)

    @cached_property
    def random_id(self):
        return self._read("random_id", 1, np.int32)[0]

    @cached_property
    def orco(self):
        return self._read("orco", 3, np.float32)

    @cached_property
    def uv(self):
        return self._read("uv", 2, np.float32)

    def _read(self, name, width, dtype):
        """Of all elements, by a loop of Blender's own, which reads each before it steps on.  It leaks the first list: of one."""
        everything = self._depsgraph.object_instances
        values = np.empty(len(everything) * width, dtype)
        everything.foreach_get(name, values)
        return values[:width].tolist()


def readable(instance, depsgraph):
    """The first element of `object_instances`, or what stands in for it."""
    if not instance.is_instance:
        return instance
    again = iter(depsgraph.object_instances)
    next(again)
    second = next(again, None)
    alone = second is None or not second.is_instance or second.parent != instance.parent
    deque(again, maxlen=0)  # left early it leaks
    return FirstInstance(instance, depsgraph) if alone else instance
