# SPDX-License-Identifier: GPL-3.0-or-later
"""Placed geometries -> the snapshot's arrays."""

from dataclasses import dataclass, replace

import numpy as np

from .identity import random_of_name, short_keys
from .snapshot import Instances
from .transforms import has_area, is_finite

VISIBLE_CAMERA = 1
CASTS_SHADOW = 2
HOLDOUT = 4


@dataclass
class KindTable:
    """What instances take from their kind, one entry a kind."""

    name: list  # of str
    geometry: np.ndarray  # int32, -1 = none
    flags: np.ndarray  # uint32
    object_index: np.ndarray  # int32
    slots: list  # of int32 arrays, material indices

    def with_more(self, names):
        """A table with more kinds at its end, of which nothing is known but names."""
        more = np.zeros(len(names), dtype=np.uint32)
        return KindTable(
            name=[*self.name, *names],
            geometry=np.append(self.geometry, np.full(len(names), -1, dtype=np.int32)),
            flags=np.append(self.flags, more),
            object_index=np.append(self.object_index, more.astype(np.int32)),
            slots=[*self.slots, *(np.zeros(0, dtype=np.int32) for _ in names)],
        )

    def renew(self, index, kind, view_layer):
        """Reads the settings of a kind again; whether they are others."""
        before = self.flags[index], self.object_index[index]
        self.flags[index], self.object_index[index] = (
            _flags(kind, view_layer),
            kind.source.pass_index,
        )
        return before != (self.flags[index], self.object_index[index])


def kind_table(kinds, view_layer, geometry, slots):
    """Copies what is wanted of each kind while its objects are alive.

    Args:
        kinds: list of depsgraph.Kind.
        view_layer: original; holds the holdouts and the indirect-only collections.
        geometry: int32 [kinds].
        slots: of `collect_materials`.
    """
    return KindTable(
        name=[kind.name for kind in kinds],
        geometry=geometry,
        flags=np.array([_flags(kind, view_layer) for kind in kinds], dtype=np.uint32),
        object_index=np.array([kind.source.pass_index for kind in kinds], dtype=np.int32),
        slots=slots,
    )


def _flags(kind, view_layer):
    """What the object and what instances it allow, and the layer's wishes.

    Holdout and indirect-only belong to objects and to collections of the view layer; an instance
    takes both from what instances it.
    """
    owners = [kind.source] + ([kind.parent] if kind.parent is not None else [])
    placed = owners[-1].original
    flags = 0
    if all(owner.visible_camera for owner in owners) and not placed.indirect_only_get(
        view_layer=view_layer
    ):
        flags |= VISIBLE_CAMERA
    if all(owner.visible_shadow for owner in owners):
        flags |= CASTS_SHADOW
    if placed.holdout_get(view_layer=view_layer):
        flags |= HOLDOUT
    return flags


def collect_materials(kinds, override):
    """Materials of all kinds, each once.

    Args:
        kinds: list of Kind.
        override: Material that replaces all, or None.

    Returns:
        (list of Material, list of int32 arrays: indices of a kind's slots, -1 = none).
    """
    materials, index, slots = [], {}, []

    def number(material):
        material = override or material
        if material is None:
            return -1
        pointer = material.as_pointer()
        if pointer not in index:
            index[pointer] = len(materials)
            materials.append(material)
        return index[pointer]

    for kind in kinds:
        wanted = kind.materials or ([override] if override and kind.type != "LIGHT" else [])
        slots.append(np.array([number(material) for material in wanted], dtype=np.int32))
    return materials, slots


def usable(scan, table, report):
    """Indices of what can be rendered: has a geometry and a place.

    Args:
        scan: depsgraph.Visit.
        table: KindTable.
        report: called with (datablock, message).
    """
    placed = table.geometry[scan.kind] >= 0
    finite = is_finite(scan.matrices)
    for i in np.flatnonzero(placed & ~finite):
        report(f"object '{table.name[scan.kind[i]]}'", "its transform is not finite: left out")
    return np.flatnonzero(placed & finite)


def unplaced_instances(scan, chosen, table):
    """The snapshot's instances, with nothing but their places missing.

    Args:
        scan: depsgraph.Visit at the frame.
        chosen: int [n], which of its things.
        table: KindTable.
    """
    kind = scan.kind[chosen]
    names = [table.name[k] for k in kind]
    random = scan.random[chosen] / float(0xFFFFFFFF)
    for i in np.flatnonzero(~scan.is_instance[chosen]):
        random[i] = random_of_name(names[i])
    return Instances(
        name=names,
        geometry=table.geometry[kind],
        knots=None,
        world_from_object=None,
        slots=np.array([len(slots) for slots in table.slots], dtype=np.int32)[kind],
        materials=np.concatenate([*(table.slots[k] for k in kind), np.zeros(0, dtype=np.int32)]),
        flags=table.flags[kind],
        object_index=table.object_index[kind],
        random=random.astype(np.float32),
        key=short_keys(scan.identity[chosen]),
    )


def place(instances, scan, chosen, tracks, lifespans, report):
    """The same with places, and when they are there.

    Args:
        instances: of `unplaced_instances`.
        scan, chosen: as there.
        tracks: path.Tracks of the things of the scan.
        lifespans: (int [m] things, float32 [m, 2]) of those that come or go within the shutter.
        report: called with (datablock, message).
    """
    matrices, knots = tracks.table(scan.matrices, chosen)
    first = np.cumsum(knots) - knots
    # What is scaled to nothing over the whole shutter has no area to render.
    for i in np.flatnonzero(~scan.has_area[chosen]):
        if not has_area(matrices[first[i] : first[i] + knots[i]]).any():
            report(f"object '{instances.name[i]}'", "is scaled to nothing: not visible")
    lifespan = None
    if len(lifespans[0]):
        lifespan = np.tile(np.array([0.0, 1.0], dtype=np.float32), (len(scan.kind), 1))
        lifespan[lifespans[0]] = lifespans[1]
        lifespan = lifespan[chosen]
    return replace(instances, world_from_object=matrices, knots=knots, lifespan=lifespan)
