# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances that are not there at the frame but at other times of the shutter.

Mostly more of what the frame has: particles that are born after it.  Where nothing of their kind is there
yet, its object is read at the frame all the same.
"""

from dataclasses import replace

import numpy as np

from .attributes import requested_names
from .blur_settings import blurs
from .changes import originals
from .depsgraph import kind_again
from .geometry import read_source
from .instance import collect_materials
from .kind import Kind, hidden_owners
from .placed import shade


class Newcomers:
    """Finds them at the other times."""

    def __init__(self, report):
        self._report = report
        self._said = set()

    def find(self, scene, now, which):
        """Of new instances those that can be taken; the scene's visit gets the kinds of them that it lacks.

        Args:
            scene: frame_scene.FrameScene.
            now: depsgraph.Visit at the depsgraph's time.
            which: int [n], things of it that are not in the scene's visit.

        Returns:
            (int [k] things of `now`, int [k] their kinds in the scene's visit).
        """
        kind = scene.visit.same_kinds(now)
        for number in np.unique(now.kind[which]):
            if kind[number] < 0:
                kind[number] = self._learn(scene, now.kinds[number], now.hashes[number])
        can_blur = np.array([k.blurs for k in scene.visit.kinds], dtype=bool)
        kind = kind[now.kind[which]]
        taken = (kind >= 0) & can_blur[kind]
        return which[taken], kind[taken]

    def _learn(self, scene, kind, name_hash):
        """Number of a kind in the scene's visit, or -1."""
        made = kind.data is not None and kind.data.as_pointer() != kind.source.data.as_pointer()
        if made or kind.parent is None or kind.type == "HAIR":
            if kind.name not in self._said:
                self._said.add(kind.name)
                self._report(
                    f"object '{kind.name}'",
                    "is made by instances that are not there at the frame: not rendered",
                )
            return -1
        owners = kind.source, kind.parent
        known = Kind(kind.type, kind.name, None, None, blurs=all(blurs(owner) for owner in owners))
        known.address, known.parent_address = (owner.original.as_pointer() for owner in owners)
        known.hidden = hidden_owners(owners)
        scan = scene.visit
        hashes = np.append(scan.hashes, name_hash)
        scene.visit = replace(scan, kinds=[*scan.kinds, known], hashes=hashes)
        scene.geometry_of_kind = np.append(scene.geometry_of_kind, np.int32(-1))
        scene.is_light = np.append(scene.is_light, kind.type == "LIGHT")
        return len(scan.kinds)


def with_newcomers(placed, scan, depsgraph, report, check_cancel):
    """A placed.Placed with everything of a visit that Newcomers were added to; the same one where there are
    none.

    Args:
        placed: of the frame.
        scan: depsgraph.Visit.
        depsgraph: evaluated, at the frame again.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.
    """
    if len(scan.kind) == len(placed.scan.kind):
        return placed
    strangers = range(len(placed.scan.kinds), len(scan.kinds))
    found = {number: _at_frame(scan.kinds[number], depsgraph) for number in strangers}
    found = {number: kind for number, kind in found.items() if kind is not None}
    used, slots = collect_materials(
        list(found.values()), depsgraph.view_layer_eval.material_override
    )
    addresses = list(placed.used_materials)
    unknown = [m for m in used if m.original.as_pointer() not in addresses]
    addresses += [material.original.as_pointer() for material in unknown]
    records, images = shade(unknown, depsgraph, report)
    materials = [*placed.materials, *records]
    # The last one serves slots without material, -1.
    numbers = np.array([*(addresses.index(m.original.as_pointer()) for m in used), -1], np.int32)

    names = requested_names(materials)
    sources = list(placed.sources)
    table = placed.table.with_more([scan.kinds[number].name for number in strangers])
    for (number, kind), own in zip(found.items(), slots):
        if kind.type == "LIGHT":
            continue
        example = int(np.flatnonzero(scan.kind == number)[0])
        source = read_source(kind, example, names, depsgraph, report, check_cancel)
        if source is not None:
            table.geometry[number] = len(sources)
            table.slots[number] = numbers[own]
            table.renew(number, kind, depsgraph.view_layer)
            sources.append(source)
        kind.forget()
    more = replace(
        placed,
        scan=scan,
        table=table,
        sources=sources,
        materials=materials,
        images=placed.images + images,
        chosen=None,
        instances=None,
    )
    more.choose(lambda _datablock, _message: None)  # said of those at the frame
    return more


def _at_frame(stranger, depsgraph):
    """Its Kind, read at the frame; None where it is hidden then, or no more the object's own geometry."""
    owners = stranger.owners(originals(), depsgraph)
    if owners is None or stranger.is_hidden_now(owners):
        return None
    thing, parent = owners
    return kind_again(thing, depsgraph, parent)
