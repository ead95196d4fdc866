# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Generated coordinates: where a mesh's vertices lie in its texture space, before shape keys and
modifiers deform it, so that textures stay on what moves.

Read where a material asks for them: Blender is asked for undeformed places one by one, 170 ns each.
"""

import numpy as np

from .attributes import vectors
from .mesh import read_points, read_topology
from .subdivision import cage_mesh

# What only moves vertices: Blender leaves such modifiers out where it makes undeformed places.
_DEFORMERS = frozenset(
    """ARMATURE CAST CLOTH COLLISION CORRECTIVE_SMOOTH CURVE DISPLACE HOOK LAPLACIANDEFORM LAPLACIANSMOOTH
    LATTICE MESH_DEFORM MESH_CACHE MESH_SEQUENCE_CACHE SHRINKWRAP SIMPLE_DEFORM SMOOTH SOFT_BODY SURFACE
    SURFACE_DEFORM WARP WAVE""".split()
)


def read_generated(mesh):
    """float32 [V, 3] of an evaluated mesh: [0, 1] within the texture space."""
    return _in_texture_space(mesh, vectors(mesh.vertices, "undeformed_co"))


def cage_generated(evaluated, cage, topology, label, depsgraph, report):
    """The same of a subdivision cage, or None where they cannot be found.

    Of a cage alone Blender does not keep undeformed places.  They are the original mesh's where modifiers
    before the subdivision only deform; else they are those of the cage made without what deforms.

    Args:
        evaluated: evaluated mesh object.
        cage: its Cage.
        topology: the cage's.
        label: the mesh's name for messages.
        depsgraph: evaluated.
        report: called with (datablock, message).
    """
    original = evaluated.original.data
    if topology.points_again(None, original) is not None:
        return _in_texture_space(original, read_points(original))
    modifiers = evaluated.modifiers
    deformers = [i for i in range(cage.index) if modifiers[i].type in _DEFORMERS]
    with cage_mesh(evaluated, cage, depsgraph, deformers) as mesh:
        if not read_topology(mesh).matches(topology):
            report(label, "its Generated coordinates follow its deformation")
            return None
        if original.shape_keys is not None:
            report(label, "its Generated coordinates follow its shape keys")
        return _in_texture_space(original, read_points(mesh))


def hair_generated(emitter, points, sizes):
    """float32 [P, 3] of a particle system's hairs: where each one's root lies in the texture space of the mesh that it
    stands on, in its present shape (Cycles).

    Args:
        emitter: evaluated mesh.
        points: float32 [P, 3], a hair's one after the other.
        sizes: int32 [hairs], how many are of each.
    """
    roots = points[np.cumsum(sizes) - sizes]
    return np.repeat(_in_texture_space(emitter, roots), sizes, axis=0)


def _in_texture_space(mesh, places):
    size = np.array(mesh.texspace_size, dtype=np.float32)
    size[size == 0.0] = 1.0
    return (places - np.array(mesh.texspace_location, dtype=np.float32)) * (0.5 / size) + 0.5
