# SPDX-License-Identifier: GPL-3.0-or-later
"""The distinct geometries of a visit, each read once."""

from dataclasses import dataclass, replace

import numpy as np

from ..base.blur_settings import deforms
from ..base.report import overheard, poll
from ..base.snapshot import Geometry
from .attributes import GENERATED
from .curves import read_curves
from .elements import split_radii
from .generated import cage_generated, hair_generated, read_generated
from .hair import read_hair
from .hair_points import HairPoints
from .mesh import read_geometry, whole_mesh
from .points import read_point_cloud
from .subdivision import Cage, cage_mesh, subdivision_record
from .velocity import read_velocity

_READERS = {"CURVES": read_curves, "POINTCLOUD": read_point_cloud}


@dataclass
class GeometrySource:
    """A geometry, and how to find it again at another time."""

    geometry: Geometry
    topology: object  # mesh.Topology or elements.Elements: `points_again`
    key: tuple  # the same in another frame, as long as nothing of `pointers` changes
    cage: Cage  # or None
    example: int  # index of one thing of the visit that has it
    pointers: frozenset  # addresses of original datablocks that it is made from
    deforms: bool  # false where its deformation blur is switched off, or its velocity says it all
    velocity: np.ndarray  # float32 [V, 3] metres a second, or None
    said: list  # [(datablock, message)], what there was to report

    @property
    def swells(self):
        """Whether radii may be others at another time without an update that says so."""
        return isinstance(self.topology, HairPoints) and self.topology.swells

    def at_frame(self, columns):
        """What `points_again` gives at the frame: float32 [V, columns]."""
        return self.widened(self.geometry.points[0], columns)

    def widened(self, points, columns):
        """Points of any time, with the frame's radii where they are wanted and have none."""
        if points.shape[1] == columns:
            return points
        return np.hstack([points, self.geometry.radius[0][:, None]])

    def exported(self, knots, adjacent):
        """The Geometry with float32 [K, V, 3 or 4] and [2, V, 3 or 4] of `points_again`; None: no others than
        at the frame."""
        geometry = self.geometry if knots is None else self._moved(knots)
        if adjacent is None:
            return geometry
        return replace(geometry, adjacent=np.ascontiguousarray(adjacent[..., :3]))

    def _moved(self, knots):
        if knots.shape[2] == 3:
            return replace(self.geometry, points=knots)
        points, radius = split_radii(knots)
        if (radius == radius[0]).all():
            radius = self.geometry.radius
        return replace(self.geometry, points=points, radius=radius)

    def is_true_after(self, touched):
        """Whether it need not be read again after what a changes.Touched holds."""
        # Blender hands hair out in world space: a place that changes moves its last bits.
        moved = touched.moved if self.key[0] == "HAIR" else frozenset()
        return (
            not self.swells
            and self.pointers.isdisjoint(touched.formed)
            and self.pointers.isdisjoint(moved)
        )


def read_geometries(scan, requested, depsgraph, report, check_cancel, known=()):
    """Reads every mesh, every set of curves and every point cloud of a visit.

    Args:
        scan: depsgraph.Visit at the depsgraph's time.
        requested: names of generic attributes that materials ask for.
        depsgraph: evaluated.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.
        known: GeometrySources of another frame that are still true.

    Returns:
        (list of GeometrySource, int32 [prototypes]: index in it, -1 for what has nothing to see).
    """
    of_prototype = np.full(len(scan.prototypes), -1, dtype=np.int32)
    examples = np.zeros(len(scan.prototypes), dtype=int)
    examples[scan.prototype[::-1]] = np.arange(len(scan.prototype))[::-1]
    sources, index = [], {}
    known = {source.key: source for source in known}
    for number, prototype in enumerate(scan.prototypes):
        if prototype.type == "LIGHT":
            continue
        poll(check_cancel)
        key = prototype.type, prototype.geometry_key()
        if key not in index:
            example = int(examples[number])
            source = known.get(_lasting_key(prototype))
            if source is not None:
                source = replace(source, example=example)
                for entry in source.said:
                    report(*entry)
            else:
                source = read_source(prototype, example, requested, depsgraph, report, check_cancel)
            index[key] = len(sources) if source else -1
            if source:
                sources.append(source)
        of_prototype[number] = index[key]
    return sources, of_prototype


def read_source(prototype, example, requested, depsgraph, report, check_cancel):
    """The GeometrySource of one InstancePrototype, or None where there is nothing to see."""
    said, note = overheard(report)
    source = _read(prototype, example, requested, depsgraph, note, check_cancel)
    if source is not None:
        source.said = said
    return source


def _read(prototype, example, requested, depsgraph, report, check_cancel):
    def with_velocity(data, found):
        """(what a reader found, the velocity of its points)."""
        if found is None:
            return None, None
        return found, read_velocity(data, found[0].points.shape[1], prototype.label, report)

    if prototype.type in _READERS:
        found = _READERS[prototype.type](prototype.data, prototype.label, requested, report)
        found, velocity = with_velocity(prototype.data, found)
    elif prototype.type == "HAIR":
        found = read_hair(
            prototype.source, prototype.system, prototype.label, depsgraph.mode, report
        )
        if found is not None and GENERATED in requested:
            hairs = found[0]
            hairs.generated = hair_generated(
                prototype.source.data, hairs.points[0], hairs.curve_sizes
            )
        velocity = None
    elif prototype.cage is None:
        with whole_mesh(prototype.source, prototype.data) as mesh:
            found = read_geometry(
                mesh,
                prototype.label,
                requested,
                report,
                check_cancel,
                is_metaball=prototype.source.type == "META",
            )
            if found is not None and GENERATED in requested:
                found[0].generated = read_generated(mesh)
            found, velocity = with_velocity(mesh, found)
    else:
        with cage_mesh(prototype.source, prototype.cage, depsgraph) as mesh:
            record = subdivision_record(prototype.cage, mesh)
            found = read_geometry(mesh, prototype.label, requested, report, check_cancel, record)
            found, velocity = with_velocity(mesh, found)
        if found is not None and GENERATED in requested:
            found[0].generated = cage_generated(
                prototype.source, prototype.cage, found[1], prototype.label, depsgraph, report
            )
    if found is None:
        return None
    can_deform = deforms(prototype.source)
    return GeometrySource(
        *found,
        key=_lasting_key(prototype),
        cage=prototype.cage,
        example=example,
        pointers=_pointers(prototype),
        deforms=can_deform and velocity is None,
        velocity=velocity if can_deform else None,
        said=[],
    )


def _lasting_key(prototype):
    """Blender keeps an evaluated datablock where it is until it evaluates it again; and an address that
    was freed may be another object's, whence the original's."""
    return prototype.type, prototype.address, prototype.geometry_key()


def _pointers(prototype):
    """Addresses of the original datablocks that a geometry is made from."""
    original = prototype.source.original
    pointers = {original.as_pointer()}
    if original.data is not None:
        pointers.add(original.data.as_pointer())
    if (
        prototype.data is not None
        and prototype.data.as_pointer() != prototype.source.data.as_pointer()
    ):
        pointers.add(prototype.parent_address)  # made by the nodes of what instances it
    return frozenset(pointers)
