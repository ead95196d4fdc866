# SPDX-License-Identifier: GPL-3.0-or-later
"""What one frame leaves to the next where Blender keeps its evaluated scene (Persistent Data).

Blender then names what changed since the last frame; everything else is still true.  Only addresses,
names and copied arrays are kept: no reference into Blender's memory outlives a frame.

    Objects that stand for themselves moved or deformed: they alone are read again.
    Anything else changed: the scene is walked anew, without the geometries that nothing touched.
"""

import numpy as np

from .attributes import requested_names
from .changes import Touched, object_names, originals
from .depsgraph import kind_again
from .geometry import read_source
from .placed import read_placed, shade
from .subdivision import simplify_level
from .transforms import from_matrix


class Kept:
    """Belongs to one RenderEngine."""

    def __init__(self):
        self._forget()

    def note(self, depsgraph):
        """After every evaluation of the depsgraph within a frame: what moved then may not stand where it
        stood before."""
        self._touched.add(depsgraph)

    def placed(self, depsgraph, report, check_cancel):
        """placed.Placed of the frame at which the depsgraph stands.  It is kept when `keep` is called."""
        self._touched.add(depsgraph)
        before, touched, settings = self._placed, self._touched, self._settings
        self._forget()
        self._settings = _settings(depsgraph)
        if before is None:
            return read_placed(depsgraph, None, report, check_cancel)
        if self._settings == settings and _renew(before, touched, depsgraph, report, check_cancel):
            return before
        true = [source for source in before.sources if source.is_true_after(touched)]
        known = true, before.attribute_names
        return read_placed(depsgraph, known, report, check_cancel)

    def keep(self, placed):
        """The frame is complete: the next may build on it."""
        self._placed = placed

    def _forget(self):
        self._placed, self._settings, self._touched = None, None, Touched()


def _settings(depsgraph):
    """What may make other things visible, or look otherwise, without being named by an update."""

    def collections(layer):
        yield (
            layer.name,
            layer.exclude,
            layer.holdout,
            layer.indirect_only,
            layer.collection.hide_render,
        )
        for child in layer.children:
            yield from collections(child)

    everything = originals()
    layer = depsgraph.view_layer
    override = layer.material_override
    return (
        depsgraph.as_pointer(),
        depsgraph.scene.as_pointer(),
        layer.name,
        simplify_level(depsgraph.scene_eval.render, depsgraph.mode),
        override.as_pointer() if override is not None else 0,
        tuple(collections(layer.layer_collection)),
        object_names(),
        list(everything),
        [
            _shown(thing.evaluated_get(depsgraph))
            for thing in everything.values()
            if thing.animation_data
        ],
    )


def _shown(thing):
    """What can be animated and is no change of place or shape."""
    visible = thing.visible_camera, thing.visible_shadow, thing.is_holdout
    return thing.hide_render, thing.pass_index, *visible


def _renew(placed, touched, depsgraph, report, check_cancel):
    """Reads again what was touched; false where only a walk can tell, which leaves `placed` good for
    nothing but its untouched sources."""
    used = _evaluated_materials(placed.used_materials, depsgraph)
    if touched.collections or used is None:
        return False
    said = list(placed.said)

    def note(datablock, message):
        said.append((datablock, message))

    placed.materials, placed.images = shade(used, depsgraph, note)
    if requested_names(placed.materials) != placed.attribute_names:
        return False
    geometry = placed.table.geometry
    users = np.bincount(geometry[geometry >= 0], minlength=len(placed.sources))
    renewed = set()
    for address, original in originals().items():
        formed = address in touched.formed
        if not (formed or address in touched.moved or address in touched.otherwise):
            continue
        thing = original.evaluated_get(depsgraph)
        things = placed.plain.things_of(thing)
        if things == []:
            continue
        if things is None or len(things) > 1 or address in touched.otherwise:
            return False
        (index,) = things
        kind = _renew_kind(placed, index, thing, depsgraph)
        if kind is None:
            return False
        if formed and kind.type != "LIGHT":
            number = geometry[placed.scan.kind[index]]
            source = None
            if number >= 0 and users[number] == 1 and not _may_make_more(thing):
                names = placed.attribute_names
                source = read_source(kind, index, names, depsgraph, note, check_cancel)
            if source is None or source.pointers != placed.sources[number].pointers:
                return False
            placed.sources[number] = source
            renewed.add(number)
        kind.forget()
    for number, source in enumerate(placed.sources):
        if number not in renewed:
            if not source.is_true_after(touched):
                return False
            said += source.said
    for entry in said:
        report(*entry)
    return True


def _evaluated_materials(addresses, depsgraph):
    """None where one is not there any more."""
    import bpy

    found = {material.as_pointer(): material for material in bpy.data.materials}
    if not all(address in found for address in addresses):
        return None
    return [found[address].evaluated_get(depsgraph) for address in addresses]


def _renew_kind(placed, index, thing, depsgraph):
    """Place and settings of one thing; its new Kind, or None where it is not what it was."""
    scan = placed.scan
    number = scan.kind[index]
    before = scan.kinds[number]
    kind = kind_again(thing, depsgraph)
    if (
        kind is None
        or kind.type != before.type
        or kind.material_addresses != before.material_addresses
    ):
        return None
    scan.kinds[number] = kind
    scan.cages[thing.as_pointer()] = kind.cage
    scan.move(index, from_matrix(thing.matrix_world))
    if placed.table.renew(number, kind, depsgraph.view_layer):
        placed.instances = None
    return kind


def _may_make_more(thing):
    """Whether instances or hair may have come with another shape."""
    return len(thing.particle_systems) > 0 or any(m.type == "NODES" for m in thing.modifiers)
