# SPDX-License-Identifier: GPL-3.0-or-later
"""Placed geometries -> the snapshot's arrays."""

from dataclasses import dataclass, replace

import numpy as np

from ..base.identity import random_of_name, short_keys
from ..base.snapshot import Instances
from ..base.transforms import has_area, is_finite
from .instance_values import (
    ON_INSTANCER_GENERATED,
    ON_INSTANCER_UV,
    GeometryValues,
    prototype_value,
)
from .particle_values import PARTICLE_KEYS, particle_values

# Of the largest scale to the smallest: what is less cannot be seen of points.
_SEEN_STRETCH = 1.1
VISIBLE_CAMERA = 1
CASTS_SHADOW = 2
HOLDOUT = 4
VISIBLE_DIFFUSE = 8
VISIBLE_GLOSSY = 16
VISIBLE_TRANSMISSION = 32
VISIBLE_VOLUME = 64
SHADOW_CATCHER = 128
TERMINATOR_OFFSET_SHIFT = 16


@dataclass
class PrototypeTable:
    """What instances take from their prototype, one entry a prototype."""

    name: list  # of str
    geometry: np.ndarray  # int32, -1 = none
    flags: np.ndarray  # uint32
    object_index: np.ndarray  # int32
    slots: list  # of int32 arrays, material indices
    values: dict  # {key of instance_values: float32 [prototypes, 4]}
    geometry_values: dict  # {key: {prototype: of GeometryValues}}
    particles: dict  # {key: {prototype: of particle_values}}

    def with_more(self, names):
        """A table with more prototypes at its end, of which nothing is known but names."""
        more = np.zeros(len(names), dtype=np.uint32)
        return PrototypeTable(
            name=[*self.name, *names],
            geometry=np.append(self.geometry, np.full(len(names), -1, dtype=np.int32)),
            flags=np.append(self.flags, more),
            object_index=np.append(self.object_index, more.astype(np.int32)),
            slots=[*self.slots, *(np.zeros(0, dtype=np.int32) for _ in names)],
            values={
                key: np.vstack([values, np.zeros((len(names), 4), dtype=np.float32)])
                for key, values in self.values.items()
            },
            geometry_values=self.geometry_values,
            particles=self.particles,
        )

    def renew(self, index, prototype, view_layer):
        """Reads the settings of a prototype again; whether they are others."""
        before = self.flags[index], self.object_index[index]
        self.flags[index], self.object_index[index] = (
            _flags(prototype, view_layer),
            prototype.source.pass_index,
        )
        for key, values in self.values.items():
            values[index] = prototype_value(prototype, key) or (0.0,) * 4
        return before != (self.flags[index], self.object_index[index])


def prototype_table(prototypes, view_layer, frame, geometry, slots, asked, report):
    """Copies what is wanted of each prototype while its objects are alive.

    Args:
        prototypes: list of depsgraph.InstancePrototype.
        view_layer: original; holds the holdouts and the indirect-only collections.
        frame: whole and part.
        geometry: int32 [prototypes].
        slots: of `collect_materials`.
        asked: keys of `requested_values`.
        report: called with (datablock, message).
    """
    made = GeometryValues(report)
    return PrototypeTable(
        name=[prototype.name for prototype in prototypes],
        geometry=geometry,
        flags=np.array(
            [_flags(prototype, view_layer) for prototype in prototypes], dtype=np.uint32
        ),
        object_index=np.array(
            [prototype.source.pass_index for prototype in prototypes], dtype=np.int32
        ),
        slots=slots,
        values={
            key: np.array(
                [prototype_value(p, key) or (0.0,) * 4 for p in prototypes], dtype=np.float32
            ).reshape(-1, 4)
            for key in sorted(asked)
        },
        geometry_values={
            key: {i: made.of(p, key) for i, p in enumerate(prototypes)} for key in sorted(asked)
        },
        particles={
            key: {i: particle_values(p, key, frame) for i, p in enumerate(prototypes)}
            for key in sorted(asked.intersection(PARTICLE_KEYS.values()))
        },
    )


def _flags(prototype, view_layer):
    """What the object and what instances it allow, and the layer's wishes.

    Holdout and indirect-only belong to objects and to collections of the view layer; an instance
    takes both from what instances it.
    """
    owners = [prototype.source] + ([prototype.parent] if prototype.parent is not None else [])
    placing = owners[-1].original
    flags = 0
    if all(owner.visible_camera for owner in owners) and not placing.indirect_only_get(
        view_layer=view_layer
    ):
        flags |= VISIBLE_CAMERA
    if all(owner.visible_shadow for owner in owners):
        flags |= CASTS_SHADOW
    if all(owner.visible_diffuse for owner in owners):
        flags |= VISIBLE_DIFFUSE
    if all(owner.visible_glossy for owner in owners):
        flags |= VISIBLE_GLOSSY
    if all(owner.visible_transmission for owner in owners):
        flags |= VISIBLE_TRANSMISSION
    if all(owner.visible_volume_scatter for owner in owners):
        flags |= VISIBLE_VOLUME
    if placing.holdout_get(view_layer=view_layer):
        flags |= HOLDOUT
    if any(owner.is_shadow_catcher for owner in owners):
        flags |= SHADOW_CATCHER
    return flags | _terminator_offset(prototype.source) << TERMINATOR_OFFSET_SHIFT


def _terminator_offset(thing):
    """0 to 65535; an object's own since Blender 4.3, before of Cycles' add-on, where that is enabled."""
    name = "shadow_terminator_geometry_offset"
    offset = getattr(thing, name, getattr(getattr(thing, "cycles", None), name, 0.1))
    return round(65535 * min(max(offset, 0.0), 1.0))


def collect_materials(prototypes, override):
    """Materials of all prototypes, each once.

    Args:
        prototypes: list of InstancePrototype.
        override: Material that replaces all, or None.

    Returns:
        (list of Material, list of int32 arrays: indices of a prototype's slots, -1 = none).
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

    for prototype in prototypes:
        wanted = prototype.materials or (
            [override] if override and prototype.type != "LIGHT" else []
        )
        slots.append(np.array([number(material) for material in wanted], dtype=np.int32))
    return materials, slots


def usable(scan, table, report):
    """Indices of what can be rendered: has a geometry and a place.

    Args:
        scan: depsgraph.Visit.
        table: PrototypeTable.
        report: called with (datablock, message).
    """
    has_geometry = table.geometry[scan.prototype] >= 0
    finite = is_finite(scan.matrices)
    for i in np.flatnonzero(has_geometry & ~finite):
        report(f"object '{table.name[scan.prototype[i]]}'", "its transform is not finite: left out")
    _report_stretched_points(scan, np.flatnonzero(has_geometry & finite), table, report)
    return np.flatnonzero(has_geometry & finite)


def _report_stretched_points(scan, things, table, report):
    """Cycles makes ellipsoids of them."""
    are_points = np.array([p.type == "POINTCLOUD" for p in scan.prototypes], dtype=bool)
    things = things[are_points[scan.prototype[things]]]
    if len(things) == 0:
        return
    lengths = np.linalg.norm(scan.matrices[things][:, :3, :3], axis=1)
    uneven = lengths.max(axis=1) > _SEEN_STRETCH * lengths.min(axis=1)
    for name in {table.name[k] for k in scan.prototype[things[uneven]]}:
        report(f"object '{name}'", "is scaled unevenly: its points stay spheres")


def unplaced_instances(scan, chosen, table):
    """The snapshot's instances, with nothing but their places missing.

    Args:
        scan: depsgraph.Visit at the frame.
        chosen: int [n], which of its things.
        table: PrototypeTable.
    """
    prototype = scan.prototype[chosen]
    names = [table.name[k] for k in prototype]
    random = scan.random[chosen] / float(0xFFFFFFFF)
    for i in np.flatnonzero(~scan.is_instance[chosen]):
        random[i] = random_of_name(names[i])
    return Instances(
        name=names,
        geometry=table.geometry[prototype],
        knots=None,
        world_from_object=None,
        slots=np.array([len(slots) for slots in table.slots], dtype=np.int32)[prototype],
        materials=np.concatenate(
            [*(table.slots[k] for k in prototype), np.zeros(0, dtype=np.int32)]
        ),
        flags=table.flags[prototype],
        object_index=table.object_index[prototype],
        random=random.astype(np.float32),
        key=short_keys(scan.identity[chosen]),
        values={key: _values(scan, chosen, table, key) for key in table.values},
    )


def _values(scan, chosen, table, key):
    """float32 [n, 4]."""
    if key in (ON_INSTANCER_GENERATED, ON_INSTANCER_UV):
        found = np.zeros((len(chosen), 4), dtype=np.float32)
        found[:, 3] = 1.0
        if scan.on_instancer is not None:
            places = scan.on_instancer[chosen]
            of_key = places[:, :3] if key == ON_INSTANCER_GENERATED else places[:, 3:]
            found[:, : of_key.shape[1]] = of_key
        return found
    prototype = scan.prototype[chosen]
    found = table.values[key][prototype]
    for number, rows in table.geometry_values[key].items():
        if rows:
            for i in np.flatnonzero(prototype == number):
                row = rows.get(int(scan.persistent[chosen[i], 2]))
                if row is not None:
                    found[i] = row
    for number, systems in table.particles.get(key, {}).items():
        things = np.flatnonzero(prototype == number)
        particle, system = scan.persistent[chosen[things], :2].T
        for k, values in enumerate(systems or ()):
            of = (system == k) & (particle >= 0) & (particle < len(values))
            found[things[of]] = values[particle[of]]
    return found


def linked(instances, scan, chosen, links):
    """The same with a light_linking.LightLinks."""
    prototype = scan.prototype[chosen]

    def of_instances(values):
        return None if values is None else values[prototype]

    return replace(
        instances,
        receives=of_instances(links.receives),
        blocks=of_instances(links.blocks),
        receiver_set=of_instances(links.receiver_set),
        blocker_set=of_instances(links.blocker_set),
        receives_in_volumes=links.receives_in_volumes,
    )


def place(instances, scan, chosen, tracks, lifespans, report):
    """The same with places, and when they are there.

    Args:
        instances: of `unplaced_instances`.
        scan, chosen: as there.
        tracks: motion_path.Tracks of the things of the scan.
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
        lifespan = np.tile(np.array([0.0, 1.0], dtype=np.float32), (len(scan.prototype), 1))
        lifespan[lifespans[0]] = lifespans[1]
        lifespan = lifespan[chosen]
    return replace(instances, world_from_object=matrices, knots=knots, lifespan=lifespan)
