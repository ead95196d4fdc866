# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as a view shows it, read at all times of the shutter.

The depsgraph of a window cannot be moved in time: it belongs to the artist, whose unkeyed changes would be lost, and
to everything else that is drawn.  So the scene is copied (its objects are shared) and the copy's own depsgraph is
evaluated: it is not the active one and writes nothing back.  The copy lives for one reading, between two events:
no list shows it, no step of undo and no file holds it (docs/decisions/viewport.md).
"""

from contextlib import contextmanager

import bpy

from ..export import export_frame
from ..export.base.report import ExportError

_HANDLERS = (
    "frame_change_pre",
    "frame_change_post",
    "depsgraph_update_pre",
    "depsgraph_update_post",
)

_is_reading = False


def is_reading():
    """Whether what Blender calls now was caused by the reading itself."""
    return _is_reading


def read_snapshot(scene_name, layer_name, viewpoint_of, report):
    """(snapshot of a scene at its frame, its export's Places).

    Args:
        viewpoint_of: called with the copied scene, returns one of export/scene/viewpoint.py.
        report: called with (datablock, message).

    Raises:
        ExportError.
    """
    with _copied(_scene(scene_name, layer_name), layer_name) as depsgraph:
        copy = depsgraph.scene
        places = []
        snapshot = export_frame(
            None,
            depsgraph,
            copy.granita,
            report,
            viewpoint=viewpoint_of(copy),
            tell_places=places.append,
        )
        return snapshot, places[0]


def read_still(scene_name, layer_name, viewpoint_of, persistent_state, report):
    """The same without motion, of the window's own depsgraph: only what changed since the last time is read.

    Args:
        persistent_state: export.PersistentState, which has noted all updates since.
    """
    scene = _scene(scene_name, layer_name)
    return export_frame(
        None,
        scene.view_layers[layer_name].depsgraph,
        scene.granita,
        report,
        persistent_state=persistent_state,
        viewpoint=viewpoint_of(scene),
        moves=False,
    )


def _scene(name, layer_name):
    scene = bpy.data.scenes.get(name)
    if scene is None or layer_name not in scene.view_layers:
        raise ExportError(f"scene '{name}'", "is gone")
    return scene


# Modifiers whose result depends on time without an animation that says so.
_LIVING = {
    "BUILD",
    "CLOTH",
    "COLLISION",
    "DYNAMIC_PAINT",
    "EXPLODE",
    "FLUID",
    "MESH_CACHE",
    "MESH_SEQUENCE_CACHE",
    "NODES",
    "PARTICLE_SYSTEM",
    "SOFT_BODY",
    "WAVE",
}


def may_move(scene_name):
    """Whether anything in the file can move by itself; false only where nothing does."""
    scene = bpy.data.scenes[scene_name]
    if len(bpy.data.actions) or len(bpy.data.cache_files) or scene.rigidbody_world is not None:
        return True
    if any("velocity" in mesh.attributes for mesh in bpy.data.meshes):
        return True
    groups = (bpy.data.objects, bpy.data.shape_keys, bpy.data.cameras, bpy.data.lights)
    groups += (bpy.data.armatures, bpy.data.meshes, bpy.data.curves, bpy.data.lattices)
    if any(block.animation_data is not None for group in groups for block in group):
        return True
    return any(m.type in _LIVING for thing in bpy.data.objects for m in thing.modifiers)


@contextmanager
def _copied(scene, layer_name):
    """The evaluated depsgraph of a copy that stands at the scene's frame."""
    global _is_reading
    _is_reading = True
    try:
        with _without_handlers():
            copy = scene.copy()
            try:
                for layer in list(copy.view_layers):
                    if layer.name != layer_name:
                        copy.view_layers.remove(layer)
                copy.frame_set(scene.frame_current, subframe=scene.frame_subframe)
                yield copy.view_layers[layer_name].depsgraph
            finally:
                bpy.data.scenes.remove(copy)
                settle()
    finally:
        _is_reading = False


def settle():
    """Evaluates what is tagged: edits before a view goes on, which hears of them now and not a drawing later; after a
    reading what the removal of a scene tags, so that no view takes it for an edit."""
    for window in bpy.context.window_manager.windows:
        window.view_layer.update()


@contextmanager
def _without_handlers():
    """Functions of other add-ons may change the file, which would be read again, and so on for ever."""
    kept = {name: list(getattr(bpy.app.handlers, name)) for name in _HANDLERS}
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).clear()
    try:
        yield
    finally:
        for name, functions in kept.items():
            getattr(bpy.app.handlers, name)[:] = functions
