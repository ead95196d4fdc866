# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of geometry nodes that carry an attribute `velocity`, metres a second in the space of the object
whose nodes they are.

Where they are at every time of the shutter says more: how they turn, and how their paths bend.  Velocity says it
where places cannot: of what stands still meanwhile, comes or goes, or is told from others by its order alone
where the number of instances changes.

Blender shows attributes of instances from 4.5 on (`evaluated_geometry`).
"""

from dataclasses import dataclass

import numpy as np

from ..base.transforms import from_matrix, inverse, volume
from ..base.updates import originals
from ..geometry.velocity import NAME, finite_velocity


@dataclass
class InstanceVelocity:
    """One instance, as it was seen at one tick."""

    owner: int  # address of the original Object whose nodes it is of
    velocity: np.ndarray  # float64 [3], metres a second, the owner's space
    tick: int
    place: np.ndarray  # float64 [4, 4], owner from object
    has_id: bool  # its identity does not depend on the order


class InstanceVelocities:
    """Those of a shutter.

    Attributes:
        of: {thing of the visit: InstanceVelocity}.
    """

    def __init__(self, seconds, report):
        """Args: seconds in a tick; report, called with (datablock, message)."""
        self.of = {}
        self._seconds = seconds
        self._report = report
        self._makers = set()  # addresses of owners
        self._matrices = {}  # tick -> {owner: float64 [4, 4], world from owner}

    def add(self, scan, things, tick, depsgraph):
        """Reads the velocities of instances, which the depsgraph has as the scan has them.

        Args:
            scan: depsgraph.Visit.
            things: int [n], of it.
            tick: at which it stands.
            depsgraph: evaluated.
        """
        parents = {
            prototype.parent_address for prototype in scan.prototypes if prototype.parent_address
        }
        makers = {
            address: thing.evaluated_get(depsgraph)
            for address, thing in (originals() if parents and len(things) else {}).items()
            if address in parents
        }
        makers = {address: found for address, o in makers.items() if (found := self._read(o))}
        self._makers |= makers.keys()
        self.note(tick, depsgraph)
        for thing in things:
            address = scan.prototypes[scan.prototype[thing]].parent_address
            if address not in makers:
                continue
            velocities, has_id = makers[address]
            velocity = velocities.get(int(scan.persistent[thing, 2]))
            world = self._matrices[tick][address]
            if velocity is None or volume(world) == 0.0:
                continue
            place = inverse(world) @ scan.matrices[thing]
            self.of[int(thing)] = InstanceVelocity(address, velocity, tick, place, has_id)

    def note(self, tick, depsgraph):
        """Where the owners are at a tick."""
        if not self._makers:
            return
        everything = originals()
        before = self._matrices.get(next(reversed(self._matrices), None), {})
        self._matrices[tick] = {
            address: from_matrix(everything[address].evaluated_get(depsgraph).matrix_world)
            if address in everything
            else before[address]
            for address in self._makers
        }

    def take(self, things, path, ticks, whole):
        """Overwrites the paths of those that go by their velocity.

        Args:
            things: int [m].
            path: float64 [T, m, 4, 4], world from object.
            ticks: of T.
            whole: bool [m], whether each is there at all ticks.
        """
        velocities = [self.of.get(int(thing)) for thing in things]
        shuffled = {
            moving.owner
            for moving, all_along in zip(velocities, whole)
            if moving is not None and not moving.has_id and not all_along
        }
        for column, moving in enumerate(velocities):
            # Where an owner was before it had instances is not known: they go by their places.
            if moving is None or any(moving.owner not in self._matrices.get(t, {}) for t in ticks):
                continue
            worlds = [self._matrices[tick][moving.owner] for tick in ticks]
            standing = np.stack([world @ moving.place for world in worlds])
            sure = whole[column] and moving.owner not in shuffled
            size = np.abs(standing).max()
            if sure and np.abs(path[:, column] - standing).max() > 1e-6 * size:
                continue
            for i, tick in enumerate(ticks):
                way = worlds[i][:3, :3] @ moving.velocity * (tick - moving.tick) * self._seconds
                path[i, column] = standing[i]
                path[i, column, :3, 3] += way

    def _read(self, maker):
        """({id of an instance: float64 [3]}, whether these are an attribute of their own) of an evaluated Object,
        or None."""
        # Ids of particles look the same; of what is no geometry, an empty, Blender 5.2 has none to show.
        has_nodes = any(modifier.type == "NODES" for modifier in maker.modifiers)
        if not has_nodes or not hasattr(maker, "evaluated_geometry") or len(maker.particle_systems):
            return None
        geometry = maker.evaluated_geometry()  # holds what is read
        instances = geometry.instances_pointcloud()
        attribute = instances.attributes.get(NAME) if instances is not None else None
        if attribute is None:
            return None
        label = f"object '{maker.name}'"
        if attribute.data_type != "FLOAT_VECTOR":
            self._report(
                label, f"'{NAME}' of its instances ({attribute.data_type}) is no vector: not used"
            )
            return None
        velocity = finite_velocity(attribute, "instance", label, self._report)
        ids = np.arange(len(velocity), dtype=np.int32)
        attribute = instances.attributes.get("id")
        if attribute is not None:
            attribute.data.foreach_get("value", ids)
        flying = np.flatnonzero(velocity.any(axis=1))[::-1]  # of equal ids the first counts
        found = dict(zip(ids[flying].tolist(), velocity[flying].astype(np.float64)))
        return (found, attribute is not None) if found else None
