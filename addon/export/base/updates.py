# SPDX-License-Identifier: GPL-3.0-or-later
"""What the last evaluations of a depsgraph touched, and what the file holds.

Only what `updates` itself holds is asked, so a handler that deleted an object meanwhile leaves no
dangling reference.
"""


def read_updates(depsgraph):
    """[(evaluated ID, whether it moved, whether its geometry changed, whether its looks did)] of the last evaluation,
    read once: each look at them costs a microsecond a thing.

    Blender 5.3 says of an object without modifiers that its geometry changed, too, where a material did that it
    wears: then its data looks otherwise and is of the same form.  That is asked of meshes alone, and not of those
    that a rig, a lattice or a curve deforms as their parent.
    """
    import bpy

    found = [
        (u.id, u.is_updated_transform, u.is_updated_geometry, u.is_updated_shading)
        for u in depsgraph.updates
    ]
    if bpy.app.version < (5, 3):
        return found
    worn = {
        thing.name_full
        for thing, _, formed, shaded in found
        if shaded and not formed and isinstance(thing, bpy.types.Mesh)
    }
    if not worn:
        return found

    def is_worn(thing):
        if not isinstance(thing, bpy.types.Object) or thing.type != "MESH" or len(thing.modifiers):
            return False
        return thing.parent_type not in ("ARMATURE", "LATTICE") and thing.data.name_full in worn

    return [
        (thing, moved, formed and not is_worn(thing), shaded)
        for thing, moved, formed, shaded in found
    ]


class Touched:
    """Everything that updates of the depsgraph named since it was made; by address of the original."""

    def __init__(self):
        self.moved, self.formed = set(), set()
        self.otherwise = set()  # objects of which something else changed
        self.collections = False

    def add(self, updates):
        """What an evaluation touched, of `read_updates`."""
        import bpy

        for thing, moved, formed, _ in updates:
            pointer = thing.original.as_pointer()
            if moved:
                self.moved.add(pointer)
            if formed:
                self.formed.add(pointer)
            if isinstance(thing, bpy.types.Collection):
                self.collections = True
            if not (moved or formed) and isinstance(thing, bpy.types.Object):
                self.otherwise.add(pointer)


def originals(depsgraph=None):
    """{address: original Object}, of the whole file; of a preview's depsgraph, of that scene, which is not of the file."""
    import bpy

    found = bpy.data.objects
    if depsgraph is not None:
        scene = depsgraph.scene
        if not any(scene.as_pointer() == known.as_pointer() for known in bpy.data.scenes):
            found = scene.objects
    return {thing.as_pointer(): thing for thing in found}


def object_names():
    """All objects of the file: another list means that something was made, deleted or renamed."""
    import bpy

    return bpy.data.objects.keys()


def lights_changed(updates):
    """Whether the last step touched any light or nodes."""
    from bpy.types import Light, NodeTree

    return any(isinstance(thing, (Light, NodeTree)) for thing, *_ in updates)


def changed_geometry(updates):
    """Addresses of the original datablocks whose geometry the last step touched."""
    return {thing.original.as_pointer() for thing, _, formed, _ in updates if formed}
