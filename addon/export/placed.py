# SPDX-License-Identifier: GPL-3.0-or-later
"""What is placed in the scene at the frame, and what it is made of."""

from dataclasses import dataclass

import numpy as np

from .attributes import requested_names
from .changes import Plain
from .depsgraph import Visit, visit
from .geometry import read_geometries
from .instance import KindTable, collect_materials, kind_table, unplaced_instances, usable
from .snapshot import Instances


@dataclass
class Placed:
    """Read at the frame; holds addresses and arrays, nothing of Blender's."""

    scan: Visit
    plain: Plain
    table: KindTable
    sources: list  # of geometry.GeometrySource
    attribute_names: set  # of the generic attributes that were read
    used_materials: list  # addresses of original Materials, in the snapshot's order
    materials: list  # records of the snapshot
    images: list  # likewise
    said: list  # [(datablock, message)], what the walk had to report
    # What of the snapshot's instances a place does not change, once it is made, and of which things.
    chosen: np.ndarray = None  # int [n]
    instances: Instances = None

    def choose(self, report):
        """Finds what can be rendered of it."""
        chosen = usable(self.scan, self.table, report)
        if self.instances is None or not np.array_equal(chosen, self.chosen):
            self.instances = unplaced_instances(self.scan, chosen, self.table)
        self.chosen = chosen

    @property
    def is_light(self):
        """bool [kinds]."""
        return np.array([kind.type == "LIGHT" for kind in self.scan.kinds], dtype=bool)

    def lights(self):
        """int [lights], things of the scan."""
        return np.flatnonzero(self.is_light[self.scan.kind])


def read_placed(depsgraph, known, report, check_cancel):
    """Walks over everything.

    Args:
        depsgraph: evaluated, at the frame.
        known: GeometrySources that need not be read again, for materials that ask for the same
            attributes: (sources, names); or None.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.
    """
    said = []

    def note(datablock, message):
        said.append((datablock, message))
        report(datablock, message)

    scan = visit(depsgraph, note, check_cancel)
    override = depsgraph.view_layer_eval.material_override
    used, slots = collect_materials(scan.kinds, override)
    materials, images = shade(used, depsgraph, report)
    known_sources, known_names = known or ((), set())
    names = requested_names(materials)
    sources, geometry_of_kind = read_geometries(
        scan, names, depsgraph, report, check_cancel, known_sources if names == known_names else ()
    )
    table = kind_table(scan.kinds, depsgraph.view_layer, geometry_of_kind, slots)
    for kind in scan.kinds:
        kind.forget()
    addresses = [material.original.as_pointer() for material in used]
    plain = Plain(scan, depsgraph.view_layer)
    return Placed(scan, plain, table, sources, names, addresses, materials, images, said)


def shade(used, depsgraph, report):
    """(records of evaluated Materials, records of the images that they show)."""
    from .material import export_materials

    aovs = {aov.name for aov in depsgraph.view_layer.aovs if aov.is_valid}
    return export_materials(used, report, aovs)
