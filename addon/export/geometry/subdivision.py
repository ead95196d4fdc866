# SPDX-License-Identifier: GPL-3.0-or-later
"""A Subsurf modifier that is last is not tessellated by Blender: its cage is exported instead.

Python always sees the subdivided mesh.  But the flags of modifiers on the *evaluated* object belong
to the render alone: with the last one switched off, `to_mesh` evaluates the stack anew and returns
the deformed cage.  `foreach_set` is used because it runs no update callback.
"""

from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ..base.updates import originals
from ..shading.used_nodes import any_node
from .mesh import has_flat_faces, unsigned
from .pointiness import asks_for_pointiness

# Blender's creases run from 0 to 1; OpenSubdiv's sharpness is 10 times their square, and 10 is
# infinitely sharp.
MAX_SHARPNESS = 10.0


@dataclass(frozen=True)
class Cage:
    """How to get at the cage of one object.

    `index` is the modifier's place in the stack, `flag` the name of the switch that counts,
    `sharing` a key: objects of one mesh with equal keys have the same cage (None: unknown).
    """

    index: int
    flag: str
    settings: tuple
    sharing: object

    @property
    def use_creases(self):
        return self.settings[3]


def find_cage(evaluated, mode, simplify_level):
    """The Cage of an object, or None where Blender's own mesh is the right one.

    Args:
        evaluated: evaluated mesh object.
        mode: the depsgraph's, "RENDER" or "VIEWPORT".
        simplify_level: most levels that the scene allows.
    """
    suffix = "render" if mode == "RENDER" else "viewport"
    flag = f"show_{suffix}"
    enabled = [i for i, modifier in enumerate(evaluated.modifiers) if getattr(modifier, flag)]
    if not enabled or evaluated.modifiers[enabled[-1]].type != "SUBSURF":
        return None
    modifier = evaluated.modifiers[enabled[-1]]
    levels = modifier.render_levels if mode == "RENDER" else modifier.levels
    # A simple subdivision is no smoother than its cage, but where its faces are smooth its normals
    # are: they belong to the vertices that Blender makes.
    if min(levels, simplify_level) < 1 or modifier.subdivision_type != "CATMULL_CLARK":
        return None
    # Particles and instances on vertices or faces sit on the subdivided mesh.
    if len(evaluated.particle_systems) or evaluated.instance_type in {"VERTS", "FACES"}:
        return None
    # What is shaded flat shows the facets of its level.
    if has_flat_faces(evaluated.data):
        return None
    original_mesh = evaluated.original.data
    if original_mesh.is_editmode:
        return None  # the modifiers would start from the mesh as it was before it was edited
    if getattr(modifier, "use_custom_normals", False) and original_mesh.has_custom_normals:
        return None
    settings = (
        modifier.subdivision_type,
        modifier.boundary_smooth,
        modifier.uv_smooth,
        modifier.use_creases,
        modifier.quality if modifier.use_limit_surface else MAX_SHARPNESS,
    )
    is_pure = len(enabled) == 1 and original_mesh.shape_keys is None
    sharing = (original_mesh.as_pointer(), settings) if is_pure else None
    return Cage(enabled[-1], flag, settings, sharing)


def asks_for_blenders_mesh(materials):
    """Whether nodes of evaluated Materials ask for vertices or faces that Blender makes, which a cage has not."""
    return asks_for_pointiness(materials) or any_node(
        materials, lambda node: node.type == "WIREFRAME" and node.outputs[0].is_linked
    )


def simplify_level(render, mode):
    """Most subdivision levels that Simplify allows."""
    if not render.use_simplify:
        return 100
    return render.simplify_subdivision_render if mode == "RENDER" else render.simplify_subdivision


def has_cage(evaluated, cage):
    """Whether it is still there: a handler of another add-on may have taken its modifier away."""
    modifiers = evaluated.modifiers
    return cage.index < len(modifiers) and modifiers[cage.index].type == "SUBSURF"


@contextmanager
def cage_mesh(evaluated, cage, depsgraph, without_too=()):
    """The deformed cage as a temporary Mesh; gone, and the modifier back on, afterwards.

    `without_too`: places in the stack of modifiers that are off as well.
    """
    modifiers = evaluated.modifiers
    flags = np.zeros(len(modifiers), dtype=np.bool_)
    modifiers.foreach_get(cage.flag, flags)
    without = flags.copy()
    without[[cage.index, *without_too]] = False
    modifiers.foreach_set(cage.flag, without)
    try:
        yield evaluated.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph)
    finally:
        evaluated.to_mesh_clear()
        modifiers.foreach_set(cage.flag, flags)


@contextmanager
def cages_only(cages, depsgraph):
    """While time is stepped: deforming surfaces are not subdivided by Blender at every knot.

    Their modifiers stay off, so that each re-evaluation stops at the cage.  That is safe only for
    objects whose mesh nothing else in the file can read; the others are left alone.

    Args:
        cages: {address of an original Object: Cage}.
        depsgraph: evaluated.
    """
    everything = originals() if cages else {}
    # Not what a handler of another add-on has deleted, or freed of its modifier, since they were found.
    cages = {
        address: cage
        for address, cage in cages.items()
        if address in everything and has_cage(everything[address].evaluated_get(depsgraph), cage)
    }
    read = _referenced([everything[address] for address in cages])
    switched = []
    try:
        for address, cage in cages.items():
            original = everything[address]
            if original in read or original.rigid_body is not None:
                continue
            evaluated = original.evaluated_get(depsgraph)
            flags = np.zeros(len(evaluated.modifiers), dtype=np.bool_)
            evaluated.modifiers.foreach_get(cage.flag, flags)
            switched.append((address, cage.flag, flags.copy()))
            flags[cage.index] = False
            evaluated.modifiers.foreach_set(cage.flag, flags)
        yield
    finally:
        # Found anew: a handler of another add-on may have deleted or replaced them meanwhile.
        everything = originals() if switched else {}
        for address, flag, flags in switched:
            original = everything.get(address)
            modifiers = original.evaluated_get(depsgraph).modifiers if original is not None else ()
            if len(modifiers) == len(flags):
                modifiers.foreach_set(flag, flags)


def _referenced(originals):
    """Objects that something may read: all that have users beside scenes and plain collections.

    A collection is not plain where it, or one around it, has such users itself (a boolean's, say).
    """
    import bpy

    read, collections, found = set(), set(), set(originals)
    while found:
        users = bpy.data.user_map(subset=found)
        found = set()
        for datablock, its_users in users.items():
            for user in its_users:
                if isinstance(user, bpy.types.Collection):
                    found.add(user)
                elif not isinstance(user, bpy.types.Scene):
                    read.add(datablock)
        found -= collections
        collections |= found
    for collection in read & collections:
        read |= set(collection.all_objects)
    return read


def sharpness(crease, quality):
    """OpenSubdiv's sharpness of Blender's creases, elementwise.

    Args:
        crease: 0 to 1.
        quality: levels to which Blender isolates features of its limit surface.  A finite
            sharpness beyond it ends there: in its own meshes, edges creased by .7 and by .9 are
            equally round at the default quality of 3.
    """
    crease = np.clip(crease, 0.0, 1.0)
    finite = np.minimum(MAX_SHARPNESS * crease * crease, quality)
    return np.where(crease < 1.0, finite, MAX_SHARPNESS).astype(np.float32)


def subdivision_record(cage, mesh):
    """The snapshot's `subdivision` of a cage mesh."""
    scheme, boundary, uv_smooth, use_creases, quality = cage.settings
    record = {"scheme": scheme, "boundary": boundary, "uv_smooth": uv_smooth}
    if not use_creases:
        return record
    edges = _creases(mesh, "crease_edge", "edge_creases", len(mesh.edges))
    if edges is not None and edges.any():
        creased = np.flatnonzero(edges > 0.0)
        verts = unsigned(mesh.edges, "vertices", 2).reshape(-1, 2)
        record["crease_verts"] = verts[creased]
        record["crease_values"] = sharpness(edges[creased], quality)
    points = _creases(mesh, "crease_vert", "vertex_creases", len(mesh.vertices))
    if points is not None and points.any():
        record["vertex_creases"] = sharpness(points, quality)
    return record


def _creases(mesh, attribute_name, legacy_name, count):
    """float32 [count], 0 to 1, or None.  They became attributes in Blender 4.0."""
    attribute = mesh.attributes.get(attribute_name)
    if attribute is None and attribute_name == "crease_edge" and count:
        if hasattr(mesh.edges[0], "crease"):
            values = np.empty(count, dtype=np.float32)
            mesh.edges.foreach_get("crease", values)
            return values
    if attribute is None:
        layers = getattr(mesh, legacy_name, None)
        if layers is None or len(layers) == 0 or not hasattr(layers[0], "data"):
            return None
        attribute = layers[0]
    values = np.empty(count, dtype=np.float32)
    attribute.data.foreach_get("value", values)
    return values
