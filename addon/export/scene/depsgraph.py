# SPDX-License-Identifier: GPL-3.0-or-later
"""One walk over `depsgraph.object_instances`: everything that is placed in the scene, at one time.

The rules of that iterator, each learnt the hard way:
- Curves, text, surfaces and metaballs come twice: as themselves, and as an instance of type MESH.
  Only the mesh counts.
- The object of an instance is a temporary; only `instance_object` and `parent` outlive the step.
- Left early, it leaks the rest of the list: it is always drained.  `foreach_get` looks at the first
  element to learn its type and leaves, so it leaks too where that object is an instancer (66 MB in
  three calls over 100,000 instances, 3.4 and 4.5): everything is read in the one loop.
- The first element may be gone when it is given: see first_instance.py.
- Touching `.data` of an object whose Subsurf is last makes Blender subdivide: cages are found first.
"""

from array import array
from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace

import numpy as np

from ..base.blur_settings import blurs, fewest_segments
from ..base.identity import combine, name_hash
from ..base.report import poll
from ..base.transforms import has_area
from ..geometry.attributes import asks_on_edges
from ..geometry.hair import hair_material, hair_systems
from ..geometry.subdivision import asks_for_blenders_mesh, find_cage, simplify_level
from .culling import culling_asked, culling_box
from .first_instance import readable
from .instance_prototype import InstancePrototype, hidden_owners
from .instance_values import place_on_instancer, takes_place_on_instancer
from .simulations import troubles, unbaked

_POLL_EVERY = 1024
_RENDERED = {"CURVES", "LIGHT", "MESH", "POINTCLOUD"}
_NO_ID = (0,) * 8
_NO_LEVEL = 2**31 - 1  # of a persistent id: less deeply nested

# What the twin of type MESH stands for, or what has no surface.
_NOT_SEEN = {
    "ARMATURE",
    "CAMERA",
    "CURVE",
    "EMPTY",
    "FONT",
    "GPENCIL",
    "GREASEPENCIL",
    "LATTICE",
    "LIGHT_PROBE",
    "META",
    "SPEAKER",
    "SURFACE",
}


@dataclass
class Visit:
    """n placed things at one time."""

    prototypes: list  # of InstancePrototype
    prototype: np.ndarray  # int32 [n], index in `prototypes`
    matrices: np.ndarray  # float64 [n, 4, 4], world from object
    identity: np.ndarray  # uint64 [n], unique, the same at every time and in every frame
    random: np.ndarray  # uint32 [n], Blender's random id; 0 where it is no instance
    is_instance: np.ndarray  # bool [n]
    # int32 [n, 3], of the persistent id: particles' index, their system's; that of the outermost instance.
    persistent: np.ndarray
    hashes: np.ndarray  # uint64 [prototypes], of names
    # float32 [n, 5], `place_on_instancer`; None where no material asks for it.
    on_instancer: np.ndarray
    cages: dict  # address of an evaluated object -> its Cage or None

    @cached_property
    def order(self):
        """int [n], ascending by identity."""
        return np.argsort(self.identity)

    @cached_property
    def has_area(self):
        """bool [n]; `move` keeps it true."""
        return has_area(self.matrices)

    def same_prototypes(self, now):
        """int [prototypes of another Visit]: index in `prototypes`, -1 = none.  Several of one name, as nodes make
        them, go by their order where there are as many."""
        found = np.full(len(now.prototypes), -1)
        for value in np.unique(now.hashes):
            here, there = np.flatnonzero(self.hashes == value), np.flatnonzero(now.hashes == value)
            if len(here) == len(there):
                found[there] = here
        return found

    def with_more(self, now, which, prototype):
        """A Visit with things of another one after its own.

        Args:
            now: Visit at another time.
            which: int [k], things of it.
            prototype: int [k], theirs here.
        """
        names = ("matrices", "identity", "random", "is_instance", "persistent")
        more = {n: np.concatenate([getattr(self, n), getattr(now, n)[which]]) for n in names}
        if self.on_instancer is not None:
            unknown = np.zeros((len(which), 5), dtype=np.float32)
            more["on_instancer"] = np.concatenate([self.on_instancer, unknown])
        return replace(
            self, prototype=np.concatenate([self.prototype, prototype]).astype(np.int32), **more
        )

    def move(self, thing, matrix):
        """Puts one thing elsewhere; matrix: float64 [4, 4]."""
        self.matrices[thing] = matrix
        self.has_area[thing] = has_area(matrix[None])[0]


def hidden_types(view_layer):
    """Types of prototypes that the filter of a view layer leaves out, as in Cycles."""
    surfaces = set() if view_layer.use_solid else {"MESH"}
    return surfaces if view_layer.use_strand else surfaces | {"CURVES", "HAIR"}


def prototype_again(thing, depsgraph, parent=None):
    """The InstancePrototype of an evaluated Object that stands for itself, or is instanced by another one as it is, as a
    visit at the frame finds it; None where it is not rendered.  What there is to report about it was
    reported by the visit."""
    walk = _Walk(depsgraph, lambda _datablock, _message: None, None)
    instance = SimpleNamespace(object=thing, instance_object=thing, parent=parent)
    index = walk.prototype_of(instance, parent is not None)
    return walk.prototypes[index] if index >= 0 else None


def visit(depsgraph, report, check_cancel, cages=None):
    """Walks once.

    Args:
        depsgraph: evaluated.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.
        cages: of the Visit at the frame, which decides what is a cage; None at the frame itself.

    Raises:
        Cancelled, or what check_cancel raises.
    """
    walk = _Walk(depsgraph, report, cages)
    prototype, rows, persistent, random, is_instance = [], array("d"), [], [], []
    on_instancer = {}
    iterator = iter(depsgraph.object_instances)
    try:
        for i, instance in enumerate(iterator):
            if i % _POLL_EVERY == 0:
                poll(check_cancel)
            if i == 0:
                instance = readable(instance, depsgraph)
            duplicate = instance.is_instance
            for index in walk.prototypes_of(instance, duplicate):
                if duplicate and walk.prototypes[index].takes_place_on_instancer:
                    on_instancer[len(prototype)] = place_on_instancer(instance)
                prototype.append(index)
                for row in instance.matrix_world:
                    rows.extend(row)
                is_instance.append(duplicate)
                persistent.append(instance.persistent_id[:] if duplicate else _NO_ID)
                random.append(instance.random_id if duplicate else 0)
    finally:
        for _ in iterator:
            pass

    prototype = np.array(prototype, dtype=np.int32)
    persistent = np.array(persistent, dtype=np.int32).reshape(-1, 8)
    hashes = np.array([name_hash(k) for k in walk.prototypes], dtype=np.uint64)
    return Visit(
        prototypes=walk.prototypes,
        prototype=prototype,
        matrices=np.frombuffer(rows, dtype=np.float64).reshape(-1, 4, 4),
        identity=combine(hashes[prototype], persistent),
        random=np.array(random, dtype=np.int32).view(np.uint32),
        is_instance=np.array(is_instance, dtype=bool),
        persistent=_parts(persistent),
        hashes=hashes,
        on_instancer=_scattered(on_instancer, len(prototype)),
        cages=walk.cages,
    )


def _scattered(rows, count):
    """float32 [count, 5] of {place: row}; None where there are none."""
    if not rows:
        return None
    found = np.zeros((count, 5), dtype=np.float32)
    found[list(rows)] = list(rows.values())
    return found


def _parts(persistent):
    """Visit.persistent of int32 [n, 8]."""
    nested = (persistent != _NO_LEVEL).sum(axis=1).clip(1) - 1
    outermost = np.take_along_axis(persistent, nested[:, None], axis=1)
    return np.hstack([persistent[:, :2], outermost])


class _Walk:
    """Sorts instances into prototypes; everything slow happens once a prototype."""

    def __init__(self, depsgraph, report, cages):
        self.prototypes = []
        self._report = report
        self._mode = depsgraph.mode
        self._hidden_types = hidden_types(depsgraph.view_layer)
        self._simplify = simplify_level(depsgraph.scene_eval.render, depsgraph.mode)
        self._culls = any(culling_asked(depsgraph.scene))
        self._index = {}
        self._hair = {}
        self._at_frame = cages is None
        self._override = depsgraph.view_layer_eval.material_override
        self._answers = {}
        self.cages = dict(cages or {})

    def prototypes_of(self, instance, duplicate):
        """Indices in `prototypes`: of the thing itself, where it is rendered, and of its hair."""
        index = self.prototype_of(instance, duplicate) if instance.show_self else -1
        found = (index,) if index >= 0 else ()
        hair = instance.show_particles and "HAIR" not in self._hidden_types
        if hair and instance.object.particle_systems:
            found += self._hair_of(instance, duplicate)
        return found

    def _hair_of(self, instance, duplicate):
        source = instance.instance_object if duplicate else instance.object
        parent = instance.parent if duplicate else None
        if duplicate and instance.object.data.as_pointer() != source.data.as_pointer():
            return ()  # something else that the object's own nodes made
        key = source.as_pointer(), parent.as_pointer() if parent is not None else 0
        found = self._hair.get(key)
        if found is None:
            found = []
            for name in hair_systems(source, self._mode):
                found.append(len(self.prototypes))
                prototype = InstancePrototype("HAIR", source.name, source, parent, system=name)
                self.prototypes.append(prototype)
                if self._at_frame:
                    material = hair_material(source, name)
                    materials = [material] if material is not None else []
                    self._look_closer(prototype, instance.object, materials)
            found = self._hair[key] = tuple(found)
        return found

    def prototype_of(self, instance, duplicate):
        """Index in `prototypes`, or -1 for what is not rendered."""
        shown = instance.object
        object_type = shown.type
        if object_type not in _RENDERED:
            if object_type not in _NOT_SEEN:
                self._report(
                    f"object '{shown.name}'", f"objects of type {object_type} are not rendered"
                )
            return -1
        if object_type in self._hidden_types:
            return -1
        source = instance.instance_object if duplicate else shown
        parent = instance.parent if duplicate else None
        cage = data = None
        if object_type == "MESH":
            cage = self._cage(source)
            # An instance may be a mesh that the object's own nodes made, not the object itself.
            if cage is None or (duplicate and self._may_make_instances(source)):
                data = shown.data
                if data is None:
                    return -1
                if cage is not None and data.as_pointer() == source.data.as_pointer():
                    data = None
                elif cage is not None:
                    cage = None
        elif object_type != "LIGHT":
            data = shown.data
            if data is None:
                return -1
        key = (
            source.as_pointer(),
            parent.as_pointer() if parent is not None else 0,
            data.as_pointer() if data is not None else 0,
        )
        index = self._index.get(key)
        if index is None:
            index = self._index[key] = len(self.prototypes)
            prototype = InstancePrototype(object_type, shown.name, source, parent, data, cage)
            self.prototypes.append(prototype)
            if self._at_frame:
                slots = () if object_type == "LIGHT" else shown.material_slots
                self._look_closer(prototype, shown, [slot.material for slot in slots])
        return index

    def _cage(self, source):
        pointer = source.as_pointer()
        if pointer not in self.cages:
            self.cages[pointer] = self._find_cage(source) if source.type == "MESH" else None
        return self.cages[pointer]

    def _find_cage(self, source):
        cage = find_cage(source, self._mode, self._simplify)
        materials = [slot.material for slot in source.material_slots]
        if cage is None or self._asks(asks_for_blenders_mesh, materials):
            return None
        # Likewise of edges.
        return None if asks_on_edges(source.data, (*materials, self._override)) else cage

    @staticmethod
    def _may_make_instances(source):
        return any(modifier.type == "NODES" for modifier in source.modifiers)

    def _asks(self, question, materials):
        key = question, *(m.as_pointer() for m in (*materials, self._override) if m is not None)
        if key not in self._answers:
            self._answers[key] = question((*materials, self._override))
        return self._answers[key]

    def _look_closer(self, prototype, shown, materials):
        """What does not change within the shutter; `shown`: the evaluated Object of one of its instances."""
        prototype.materials = materials
        if self._culls and prototype.type != "LIGHT":
            prototype.culling_box = culling_box(shown)
        prototype.takes_place_on_instancer = prototype.parent is not None and self._asks(
            takes_place_on_instancer, materials
        )
        prototype.material_addresses = tuple(m.original.as_pointer() if m else 0 for m in materials)
        owners = (
            [prototype.source] if prototype.parent is None else [prototype.source, prototype.parent]
        )
        prototype.address = prototype.source.original.as_pointer()
        prototype.parent_address = (
            owners[1].original.as_pointer() if prototype.parent is not None else 0
        )
        prototype.blurs = all(blurs(owner) for owner in owners)
        prototype.fewest_segments = fewest_segments(prototype.source)
        prototype.hidden = hidden_owners(owners)
        prototype.unbaked = tuple((owner.name, name) for owner in owners for name in unbaked(owner))
        for owner in owners:
            for trouble in troubles(owner):
                self._report(f"object '{owner.name}'", trouble)
