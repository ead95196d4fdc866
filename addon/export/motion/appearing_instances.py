# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances that are not there at the frame but at other times of the shutter.

Mostly more of what the frame has: particles that are born after it.  Where none of their prototype is there
yet, its object is read at the frame all the same.
"""

from dataclasses import replace

import numpy as np

from ..base.blur_settings import blurs
from ..base.updates import originals
from ..geometry.attributes import requested_names
from ..geometry.geometry_source import read_source
from ..scene.depsgraph import prototype_again
from ..scene.instance import collect_materials
from ..scene.instance_prototype import InstancePrototype, hidden_owners
from ..scene.scene_objects import shade


class AppearingInstances:
    """Finds them at the other times."""

    def __init__(self, report):
        self._report = report
        self._said = set()

    def find(self, scene, now, which):
        """Of new instances those that can be taken; the scene's visit gets the prototypes of them that it lacks.

        Args:
            scene: frame_scene.FrameScene.
            now: depsgraph.Visit at the depsgraph's time.
            which: int [n], things of it that are not in the scene's visit.

        Returns:
            (int [k] things of `now`, int [k] their prototypes in the scene's visit).
        """
        prototype = scene.visit.same_prototypes(now)
        for number in np.unique(now.prototype[which]):
            if prototype[number] < 0:
                prototype[number] = self._learn(scene, now.prototypes[number], now.hashes[number])
        can_blur = np.array([k.blurs for k in scene.visit.prototypes], dtype=bool)
        prototype = prototype[now.prototype[which]]
        taken = (prototype >= 0) & can_blur[prototype]
        return which[taken], prototype[taken]

    def _learn(self, scene, prototype, name_hash):
        """Number of a prototype in the scene's visit, or -1."""
        made = (
            prototype.data is not None
            and prototype.data.as_pointer() != prototype.source.data.as_pointer()
        )
        if made or prototype.parent is None or prototype.type == "HAIR":
            if prototype.name not in self._said:
                self._said.add(prototype.name)
                self._report(
                    f"object '{prototype.name}'",
                    "is made by instances that are not there at the frame: not rendered",
                )
            return -1
        owners = prototype.source, prototype.parent
        known = InstancePrototype(
            prototype.type, prototype.name, None, None, blurs=all(blurs(owner) for owner in owners)
        )
        known.address, known.parent_address = (owner.original.as_pointer() for owner in owners)
        known.hidden = hidden_owners(owners)
        scan = scene.visit
        hashes = np.append(scan.hashes, name_hash)
        scene.visit = replace(scan, prototypes=[*scan.prototypes, known], hashes=hashes)
        scene.geometry_of_prototype = np.append(scene.geometry_of_prototype, np.int32(-1))
        scene.is_light = np.append(scene.is_light, prototype.type == "LIGHT")
        return len(scan.prototypes)


def with_appearing_instances(scene_objects, scan, depsgraph, report, check_cancel):
    """SceneObjects with everything of a visit that AppearingInstances were added to; the same ones where
    there are none.

    Args:
        scene_objects: of the frame.
        scan: depsgraph.Visit.
        depsgraph: evaluated, at the frame again.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled.
    """
    if len(scan.prototype) == len(scene_objects.scan.prototype):
        return scene_objects
    strangers = range(len(scene_objects.scan.prototypes), len(scan.prototypes))
    found = {number: _at_frame(scan.prototypes[number], depsgraph) for number in strangers}
    found = {number: prototype for number, prototype in found.items() if prototype is not None}
    used, slots = collect_materials(
        list(found.values()), depsgraph.view_layer_eval.material_override
    )
    addresses = list(scene_objects.used_materials)
    unknown = [m for m in used if m.original.as_pointer() not in addresses]
    addresses += [material.original.as_pointer() for material in unknown]
    records, images = shade(unknown, depsgraph, report)
    materials = [*scene_objects.materials, *records]
    # The last one serves slots without material, -1.
    numbers = np.array([*(addresses.index(m.original.as_pointer()) for m in used), -1], np.int32)

    names = requested_names(materials)
    sources = list(scene_objects.sources)
    table = scene_objects.table.with_more([scan.prototypes[number].name for number in strangers])
    for (number, prototype), own in zip(found.items(), slots):
        if prototype.type == "LIGHT":
            continue
        example = int(np.flatnonzero(scan.prototype == number)[0])
        source = read_source(prototype, example, names, depsgraph, report, check_cancel)
        if source is not None:
            table.geometry[number] = len(sources)
            table.slots[number] = numbers[own]
            table.renew(number, prototype, depsgraph.view_layer)
            sources.append(source)
        prototype.forget()
    more = replace(
        scene_objects,
        scan=scan,
        table=table,
        sources=sources,
        materials=materials,
        images=scene_objects.images + images,
        chosen=None,
        instances=None,
    )
    more.choose(lambda _datablock, _message: None)  # said of those at the frame
    return more


def _at_frame(stranger, depsgraph):
    """Its InstancePrototype, read at the frame; None where it is hidden then, or no more the object's own geometry."""
    owners = stranger.owners(originals(), depsgraph)
    if owners is None or stranger.is_hidden_now(owners):
        return None
    thing, parent = owners
    return prototype_again(thing, depsgraph, parent)
