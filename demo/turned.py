# SPDX-License-Identifier: GPL-3.0-or-later
"""Turned chess pieces: control cages of a surface of revolution, to be subdivided."""

import math

import bpy

SEGMENTS = 12

# Radius and height up the axis; two rings close together keep an edge tight under subdivision.
FOOT = (
    (0.62, 0.00), (0.66, 0.02), (0.66, 0.12), (0.64, 0.17), (0.52, 0.22), (0.50, 0.30),
    (0.47, 0.36), (0.34, 0.46),
)  # fmt: skip
PAWN = (
    *FOOT, (0.24, 0.70), (0.20, 0.98), (0.22, 1.06), (0.38, 1.10), (0.39, 1.15), (0.24, 1.19),
    (0.22, 1.23), (0.36, 1.34), (0.40, 1.50), (0.33, 1.68), (0.17, 1.78), (0.03, 1.80),
)  # fmt: skip
ROOK = (
    *FOOT, (0.30, 0.80), (0.28, 1.25), (0.30, 1.38), (0.46, 1.43), (0.47, 1.50), (0.40, 1.55),
    (0.46, 1.60), (0.47, 1.95), (0.45, 1.98), (0.33, 1.98), (0.31, 1.95), (0.31, 1.78),
    (0.28, 1.76), (0.03, 1.76),
)  # fmt: skip
BISHOP = (
    *FOOT, (0.25, 0.85), (0.20, 1.40), (0.22, 1.50), (0.42, 1.54), (0.43, 1.60), (0.26, 1.65),
    (0.24, 1.72), (0.37, 1.90), (0.36, 2.10), (0.20, 2.38), (0.09, 2.48), (0.13, 2.56),
    (0.12, 2.66), (0.03, 2.70),
)  # fmt: skip


def turned_mesh(name: str, profile: tuple, material: bpy.types.Material) -> bpy.types.Mesh:
    """A closed cage of quads around z with a cap of one polygon at either end; u around, v up."""
    rings = len(profile)
    angles = [2 * math.pi * k / SEGMENTS for k in range(SEGMENTS)]
    vertices = [(r * math.cos(a), r * math.sin(a), z) for r, z in profile for a in angles]
    faces, uvs = [], []
    for ring in range(rings - 1):
        for k in range(SEGMENTS):
            after = (k + 1) % SEGMENTS
            low, high = ring * SEGMENTS, (ring + 1) * SEGMENTS
            faces.append((low + k, low + after, high + after, high + k))
            v0, v1 = profile[ring][1] * 0.5, profile[ring + 1][1] * 0.5
            u0, u1 = k / SEGMENTS, (k + 1) / SEGMENTS
            uvs += [(v0, u0), (v0, u1), (v1, u1), (v1, u0)]
    faces.append(tuple(range(SEGMENTS))[::-1])
    faces.append(tuple((rings - 1) * SEGMENTS + k for k in range(SEGMENTS)))
    uvs += [(0.0, k / SEGMENTS) for k in range(2 * SEGMENTS)]

    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", [c for uv in uvs for c in uv])
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    mesh.materials.append(material)
    return mesh


def piece(name: str, mesh: bpy.types.Mesh, location: tuple) -> bpy.types.Object:
    """An object of the shared cage, subdivided by its last modifier."""
    result = bpy.data.objects.new(name, mesh)
    result.location = location
    subdivision = result.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = 1
    subdivision.render_levels = 3
    bpy.context.scene.collection.objects.link(result)
    return result
