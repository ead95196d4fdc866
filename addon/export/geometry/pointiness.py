# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry > Pointiness: how far what is around a vertex lies below it, as Cycles finds it."""

import numpy as np

from ..shading.used_nodes import any_node


def asks_for_pointiness(materials):
    """Whether nodes of evaluated Materials, or of groups in them, do."""
    return any_node(
        materials,
        lambda node: node.type == "NEW_GEOMETRY" and node.outputs["Pointiness"].is_linked,
    )


def pointiness(points, normals, edges):
    """The angle between the normal and the mean way to neighbours over pi, averaged with the neighbours' own:
    .5 where all is flat, more on ridges.  Vertices at one place are one.

    Args:
        points: float32 [V, 3].
        normals: float32 [V, 3], of vertices.
        edges: int32 [E, 2].

    Returns:
        float32 [V]; 0 where no edge ends.
    """
    places, first, of = np.unique(points, axis=0, return_index=True, return_inverse=True)
    of, count = of.reshape(-1), len(places)
    normal = _unit(_sums(of, normals.astype(np.float64), count))
    pairs = np.unique(np.sort(of[edges], axis=1), axis=0)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    ends, others = pairs.ravel(), pairs[:, ::-1].ravel()
    ways = _unit(points[first[others]].astype(np.float64) - points[first[ends]])
    met = np.bincount(ends, minlength=count)
    mean = _sums(ends, ways, count) / np.maximum(met, 1)[:, None]
    angles = np.arccos(np.clip((normal * mean).sum(axis=1), -1.0, 1.0)) / np.pi
    angles[met == 0] = 0.0
    around = np.bincount(ends, angles[others], minlength=count)
    return ((angles + around) / (met + 1))[of].astype(np.float32)


def _sums(where, vectors, count):
    """float64 [count, 3]."""
    return np.stack([np.bincount(where, column, minlength=count) for column in vectors.T], axis=1)


def _unit(vectors):
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)
