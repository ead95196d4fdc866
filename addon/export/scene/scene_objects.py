# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's objects at the frame, and what it is made of."""

from dataclasses import dataclass

import numpy as np

from ..base.report import overheard
from ..base.snapshot import Instances
from ..geometry.attributes import requested_names
from ..geometry.geometry_source import read_geometries
from ..geometry.subdivision import asks_for_blenders_mesh
from .culling import Culling
from .depsgraph import Visit, visit
from .instance import PrototypeTable, collect_materials, prototype_table, unplaced_instances, usable
from .instance_values import requested_values
from .plain_objects import PlainObjects


@dataclass
class SceneObjects:
    """Read at the frame; holds addresses and arrays, nothing of Blender's."""

    scan: Visit
    plain: PlainObjects
    table: PrototypeTable
    sources: list  # of geometry.GeometrySource
    attribute_names: set  # of the generic attributes that were read
    used_materials: list  # addresses of original Materials, in the snapshot's order
    blenders_meshes: list  # of each of them, bool: asks_for_blenders_mesh()
    materials: list  # records of the snapshot
    images: list  # likewise
    said: list  # [(datablock, message)], what the walk had to report
    # What of the snapshot's instances a place does not change, once it is made, and of which things.
    chosen: np.ndarray = None  # int [n]
    instances: Instances = None
    hidden: frozenset = frozenset()  # of the viewpoint
    culling: Culling = None  # from the viewpoint; None: all stay

    def choose(self, report):
        """Finds what can be rendered of it."""
        chosen = usable(self.scan, self.table, report)
        chosen = chosen[self._is_shown()[chosen]]
        if self.culling is not None:
            chosen = chosen[~self.culling.left_out(self.scan)[chosen]]
        if self.instances is None or not np.array_equal(chosen, self.chosen):
            self.instances = unplaced_instances(self.scan, chosen, self.table)
        self.chosen = chosen

    @property
    def is_light(self):
        """bool [prototypes]."""
        return np.array(
            [prototype.type == "LIGHT" for prototype in self.scan.prototypes], dtype=bool
        )

    def lights(self):
        """int [lights], things of the scan."""
        return np.flatnonzero(self.is_light[self.scan.prototype] & self._is_shown())

    def _is_shown(self):
        """bool [n]: an instance is hidden with what places it."""
        prototypes = self.scan.prototypes
        hidden = [(p.parent_address or p.address) in self.hidden for p in prototypes]
        return ~np.array(hidden, dtype=bool)[self.scan.prototype]


def read_scene_objects(depsgraph, known, report, check_cancel):
    """Walks over everything.

    Args:
        depsgraph: evaluated, at the frame.
        known: GeometrySources that need not be read again, for materials that ask for the same
            attributes: (sources, names); or None.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.
    """
    said, note = overheard(report)
    scan = visit(depsgraph, note, check_cancel)
    override = depsgraph.view_layer_eval.material_override
    used, slots = collect_materials(scan.prototypes, override)
    materials, images = shade(used, depsgraph, report)
    known_sources, known_names = known or ((), set())
    names = requested_names(materials)
    sources, geometry_of_prototype = read_geometries(
        scan, names, depsgraph, report, check_cancel, known_sources if names == known_names else ()
    )
    table = prototype_table(
        scan.prototypes,
        depsgraph.view_layer,
        depsgraph.scene_eval.frame_current_final,
        geometry_of_prototype,
        slots,
        requested_values(materials),
        note,
    )
    for prototype in scan.prototypes:
        prototype.forget()
    addresses = [material.original.as_pointer() for material in used]
    plain = PlainObjects(scan, depsgraph.view_layer)
    asked = [asks_for_blenders_mesh([material]) for material in used]
    return SceneObjects(
        scan, plain, table, sources, names, addresses, asked, materials, images, said
    )


def shade(used, depsgraph, report):
    """(records of evaluated Materials, records of the images that they show)."""
    from ..shading.layer_values import set_layer_values
    from ..shading.material import export_materials

    aovs = {aov.name for aov in depsgraph.view_layer.aovs if aov.is_valid}
    records, images = export_materials(used, report, aovs)
    set_layer_values(records, depsgraph.scene_eval, depsgraph.view_layer_eval)
    return records, images
