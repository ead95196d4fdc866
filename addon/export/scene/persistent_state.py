# SPDX-License-Identifier: GPL-3.0-or-later
"""What one frame leaves to the next where Blender keeps its evaluated scene (Persistent Data).

Blender then names what changed since the last frame; everything else is still true.  Only addresses,
names and copied arrays are kept: no reference into Blender's memory outlives a frame.

    Objects that stand for themselves moved or deformed: they alone are read again.
    Anything else changed: the scene is walked anew, without the geometries that nothing touched.
"""

import numpy as np

from ..base.transforms import from_matrix
from ..base.updates import Touched, object_names, originals, read_updates
from ..geometry.attributes import requested_names
from ..geometry.geometry_source import read_source
from ..geometry.subdivision import asks_for_blenders_mesh, simplify_level
from .culling import culling_asked
from .depsgraph import hidden_types, prototype_again
from .instance_values import requested_values
from .scene_objects import read_scene_objects, shade


class PersistentState:
    """Belongs to one RenderEngine."""

    def __init__(self):
        self._forget()

    def note(self, depsgraph):
        """After every evaluation of the depsgraph within a frame: what moved then may not stand where it
        stood before.  Returns what `read_updates` has found."""
        updates = read_updates(depsgraph)
        self._touched.add(updates)
        return updates

    def scene_objects(self, depsgraph, report, check_cancel):
        """SceneObjects of the frame at which the depsgraph stands.  They are kept when `keep` is called."""
        self.note(depsgraph)
        before, touched, settings = self._scene_objects, self._touched, self._settings
        self._forget()
        self._settings = _settings(depsgraph)
        if before is None:
            return read_scene_objects(depsgraph, None, report, check_cancel)
        if self._settings == settings and _renew(before, touched, depsgraph, report, check_cancel):
            return before
        true = [source for source in before.sources if source.is_true_after(touched)]
        known = true, before.attribute_names
        return read_scene_objects(depsgraph, known, report, check_cancel)

    def keep(self, scene_objects):
        """The frame is complete: the next may build on it."""
        self._scene_objects = scene_objects

    def _forget(self):
        self._scene_objects, self._settings, self._touched = None, None, Touched()


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
        any(culling_asked(depsgraph.scene)),
        override.as_pointer() if override is not None else 0,
        hidden_types(layer),
        tuple(collections(layer.layer_collection)),
        object_names(),
        list(everything),
        depsgraph.mode == "VIEWPORT"
        and [t.visible_get(view_layer=layer) for t in everything.values()],
        [
            _shown(thing.evaluated_get(depsgraph))
            for thing in everything.values()
            if thing.animation_data
        ],
    )


def _shown(thing):
    """What can be animated and is no change of place or shape."""
    visible = thing.visible_camera, thing.visible_shadow, thing.is_holdout, thing.is_shadow_catcher
    to_surfaces = thing.visible_diffuse, thing.visible_glossy, thing.visible_transmission
    to_light = *to_surfaces, thing.visible_volume_scatter
    return thing.hide_render, thing.pass_index, *visible, *to_light


def _renew(scene_objects, touched, depsgraph, report, check_cancel):
    """Reads again what was touched; false where only a walk can tell, which leaves `scene_objects` good for
    nothing but its untouched sources."""
    used = _evaluated_materials(scene_objects.used_materials, depsgraph)
    if touched.collections or used is None:
        return False
    said = list(scene_objects.said)

    def note(datablock, message):
        said.append((datablock, message))

    scene_objects.materials, scene_objects.images = shade(used, depsgraph, note)
    if requested_names(scene_objects.materials) != scene_objects.attribute_names:
        return False
    if [asks_for_blenders_mesh([material]) for material in used] != scene_objects.blenders_meshes:
        return False
    if requested_values(scene_objects.materials):
        return False  # any property of an object may be meant
    geometry = scene_objects.table.geometry
    users = np.bincount(geometry[geometry >= 0], minlength=len(scene_objects.sources))
    renewed = set()
    for address, original in originals().items():
        formed = address in touched.formed
        if not (formed or address in touched.moved or address in touched.otherwise):
            continue
        thing = original.evaluated_get(depsgraph)
        things = scene_objects.plain.things_of(thing)
        if things == []:
            continue
        if things is None or len(things) > 1 or address in touched.otherwise:
            return False
        (index,) = things
        prototype = _renew_prototype(scene_objects, index, thing, depsgraph)
        if prototype is None:
            return False
        if formed and prototype.type != "LIGHT":
            number = geometry[scene_objects.scan.prototype[index]]
            source = None
            if number >= 0 and users[number] == 1 and not _may_make_more(thing):
                names = scene_objects.attribute_names
                source = read_source(prototype, index, names, depsgraph, note, check_cancel)
            if source is None or source.pointers != scene_objects.sources[number].pointers:
                return False
            scene_objects.sources[number] = source
            renewed.add(number)
        prototype.forget()
    for number, source in enumerate(scene_objects.sources):
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


def _renew_prototype(scene_objects, index, thing, depsgraph):
    """Place and settings of one thing; its new InstancePrototype, or None where it is not what it was."""
    scan = scene_objects.scan
    number = scan.prototype[index]
    before = scan.prototypes[number]
    prototype = prototype_again(thing, depsgraph)
    if (
        prototype is None
        or prototype.type != before.type
        or prototype.material_addresses != before.material_addresses
    ):
        return None
    scan.prototypes[number] = prototype
    scan.cages[thing.as_pointer()] = prototype.cage
    scan.move(index, from_matrix(thing.matrix_world))
    if scene_objects.table.renew(number, prototype, depsgraph.view_layer):
        scene_objects.instances = None
    return prototype


def _may_make_more(thing):
    """Whether instances or hair may have come with another shape."""
    return len(thing.particle_systems) > 0 or any(m.type == "NODES" for m in thing.modifiers)
