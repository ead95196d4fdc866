# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes -> arrays, by `foreach_get` alone.

Buffers have Blender's own type (float32, int32, bool; uint32 where Blender has "unsigned"): any other leaves
the fast path, ten times as long: 15 ms of a frame for 484,000 corners.
"""

from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ..base.report import counted, poll
from ..base.snapshot import Geometry
from .attributes import ISLANDS, POINTINESS, Attribute, finite_attributes, mesh_attributes, vectors
from .pointiness import pointiness


@dataclass(frozen=True)
class Topology:
    """Which vertices make which faces: what must not change for deformation to be motion."""

    vertex_count: int
    corner_verts: np.ndarray  # int32 [C]
    face_sizes: np.ndarray  # int32 [F]

    def matches(self, other):
        return (
            self.vertex_count == other.vertex_count
            and np.array_equal(self.corner_verts, other.corner_verts)
            and np.array_equal(self.face_sizes, other.face_sizes)
        )

    def points_again(self, _thing, mesh):
        """float32 [V, 3] at another time, or None where the mesh is not the frame's any more."""
        if len(mesh.vertices) != self.vertex_count or len(mesh.loops) != len(self.corner_verts):
            return None
        return read_points(mesh) if read_topology(mesh).matches(self) else None


@contextmanager
def whole_mesh(thing, mesh):
    """The mesh itself, or where it is in Edit Mode a temporary one of the object that shows it: the evaluated
    one wraps what is edited and has no vertices for Python.  As in Cycles.

    Args:
        thing: evaluated Object.
        mesh: its evaluated data, or what its nodes made.
    """
    if not getattr(mesh, "is_editmode", False):
        yield mesh
        return
    try:
        yield thing.to_mesh()
    finally:
        thing.to_mesh_clear()


def read_topology(mesh):
    """Topology of a mesh, as Blender has it."""
    attribute = mesh.attributes.get(".corner_vert")
    if attribute is not None:
        corner_verts = np.empty(len(mesh.loops), dtype=np.int32)
        attribute.data.foreach_get("value", corner_verts)
        # Faces lie in order here, and how many corners each has is found out one by one.
        starts = np.append(unsigned(mesh.polygons, "loop_start"), np.int32(len(corner_verts)))
        face_sizes = np.diff(starts)
    else:
        corner_verts = unsigned(mesh.loops, "vertex_index")
        face_sizes = unsigned(mesh.polygons, "loop_total")
    return Topology(len(mesh.vertices), corner_verts, face_sizes)


def unsigned(collection, member, width=1):
    """int32 [n * width]."""
    values = np.empty(len(collection) * width, dtype=np.uint32)
    collection.foreach_get(member, values)
    return values.view(np.int32)


def read_points(mesh):
    """float32 [V, 3], object space."""
    attribute = mesh.attributes.get("position")
    return vectors(attribute.data) if attribute is not None else vectors(mesh.vertices, "co")


def read_geometry(
    mesh, label, requested, report, check_cancel, subdivision=None, is_metaball=False
):
    """One geometry with one knot.

    Args:
        mesh: evaluated Mesh.
        label: its name for messages, "mesh 'Cube'".
        requested: names of generic attributes that materials ask for.
        report: called with (datablock, message).
        check_cancel: true when the user has cancelled; asked between the long steps.
        subdivision: record of a cage, or None.
        is_metaball: the mesh is one's.

    Returns:
        (Geometry, Topology of the mesh as Blender has it), or None where there is no face to see.
    """
    poll(check_cancel, _bytes_of(mesh))
    topology = read_topology(mesh)
    if len(topology.face_sizes) == 0:
        return None
    poll(check_cancel)
    geometry = Geometry(
        name=label,
        points=read_points(mesh)[None],
        face_sizes=topology.face_sizes,
        corner_verts=topology.corner_verts,
        material_index=_material_index(mesh),
        subdivision=subdivision,
    )
    poll(check_cancel)
    is_cage = subdivision is not None
    geometry.attributes = mesh_attributes(mesh, label, requested, report, is_cage)
    if ISLANDS in requested:
        geometry.edges = _edges(mesh)
    if POINTINESS in requested:
        normals = vectors(mesh.vertices, "normal")
        values = pointiness(geometry.points[0], normals, _edges(mesh))
        found = Attribute(POINTINESS, "POINT", "GENERIC", values[:, None])
        finite_attributes([found], label, report)
        geometry.attributes.append(found)
    poll(check_cancel)
    if subdivision is None:
        geometry.ngon_triangles = _ngon_triangles(mesh, topology)
        geometry.quads_by_normal = _are_quads_cut_by_normal()
        geometry.smooth, geometry.corner_normals = _shading(mesh, topology, is_metaball)
        if geometry.corner_normals is not None and not np.isfinite(geometry.corner_normals).all():
            report(label, "its normals are not finite: computed from the faces instead")
            geometry.corner_normals = None
    else:
        geometry.smooth = _smooth(mesh)
    poll(check_cancel)
    _drop_broken_faces(geometry, report)
    return (geometry, topology) if len(geometry.face_sizes) else None


def _bytes_of(mesh):
    """At least what is copied of a mesh: what one of millions of faces takes between two polls."""
    of_corners = len(mesh.loops) * 4 * (1 + 2 * len(mesh.uv_layers))
    colors = sum(len(layer.data) for layer in mesh.color_attributes)
    return of_corners + 4 * len(mesh.polygons) + 12 * len(mesh.vertices) + 16 * colors


def _edges(mesh):
    return unsigned(mesh.edges, "vertices", 2).reshape(-1, 2)


def _are_quads_cut_by_normal():
    """What Blender 3.4's Cycles draws; 4.2's, 4.5's and 5.0's do not.  Blender cuts by normals that a mesh has already,
    as evaluated ones had until 4.0."""
    import bpy

    return bpy.app.version < (4, 1)


def _ngon_triangles(mesh, topology):
    """int32 [T, 3]: Blender's own triangles of the faces of more than four corners, as corner numbers
    within the face; or None where there is no such face.  Smaller faces are cut by a simple rule."""
    sizes = topology.face_sizes
    if (sizes <= 4).all():
        return None
    mesh.calc_loop_triangles()
    corners = unsigned(mesh.loop_triangles, "loops", 3).reshape(-1, 3)
    large = np.repeat(sizes > 4, np.maximum(sizes - 2, 0))
    starts = np.repeat(np.cumsum(sizes) - sizes, np.maximum(sizes - 2, 0))
    return np.ascontiguousarray(corners[large] - starts[large, None])


def _material_index(mesh):
    # A mesh without this attribute has one material; asking its polygons costs .3 s a million.
    values = _values(mesh, "material_index", np.int32)
    return values if values.any() else None


def _values(mesh, name, dtype):
    """[n] of an attribute of one number; none where the mesh does not have it."""
    attribute = mesh.attributes.get(name)
    values = np.zeros(0 if attribute is None else len(attribute.data), dtype=dtype)
    if attribute is not None:
        attribute.data.foreach_get("value", values)
    return values


def _smooth(mesh):
    """uint8 [F], or None where all are flat."""
    values = np.zeros(len(mesh.polygons), dtype=np.bool_)
    if hasattr(mesh, "normals_domain"):
        # Since Blender 4.1 an attribute, which faces are asked for one by one: 30 ns each.
        attribute = mesh.attributes.get("sharp_face")
        if attribute is not None:
            attribute.data.foreach_get("value", values)
        np.logical_not(values, out=values)
    else:
        mesh.polygons.foreach_get("use_smooth", values)
    return values.view(np.uint8) if values.any() else None


def has_flat_faces(mesh):
    """Whether any face is shaded flat."""
    if getattr(mesh, "normals_domain", None) == "POINT":
        return False
    smooth = _smooth(mesh)
    return smooth is None or not smooth.all()


def _shading(mesh, topology, is_metaball):
    """(uint8 [F] or None, float32 [C, 3] or None): smooth flags, and normals where these do not
    say it all; those are for flat faces too.

    From Blender 4.1 on custom normals and sharp edges alone split normals in Cycles, though the
    mesh itself splits them between flat faces and smooth ones as well, which 5.2 takes over.  Before,
    Auto Smooth does, and a metaball's vertices have the normals of its field, which at creases are not those of its faces.
    """
    if hasattr(mesh, "normals_domain"):
        if mesh.normals_domain == "FACE":
            return None, None
        import bpy

        if mesh.normals_domain == "CORNER" and bpy.app.version >= (5, 2):
            return _smooth(mesh), vectors(mesh.corner_normals)
        if mesh.has_custom_normals or _values(mesh, "sharp_edge", np.bool_).any():
            return _smooth(mesh), vectors(mesh.corner_normals)
        return _smooth(mesh), None
    smooth = _smooth(mesh)
    if is_metaball:
        return smooth, vectors(mesh.vertices, "normal")[topology.corner_verts]
    if not mesh.use_auto_smooth:
        return smooth, None
    # On the evaluated mesh: the layer is the render's own, and is freed at once.
    mesh.calc_normals_split()
    normals = vectors(mesh.loops, "normal")
    mesh.free_normals_split()
    return smooth, normals


def _drop_broken_faces(geometry, report):
    """Takes out faces with vertices that are not finite, or with less than three corners."""
    few_corners = geometry.face_sizes < 3
    if np.isfinite(geometry.points).all() and not few_corners.any():
        return
    bad_points = ~np.isfinite(geometry.points[0]).all(axis=1)
    face_of_corner = np.repeat(np.arange(len(geometry.face_sizes)), geometry.face_sizes)
    bad_faces = few_corners.copy()
    bad_faces[face_of_corner[bad_points[geometry.corner_verts]]] = True
    if bad_points.any():
        report(
            geometry.name,
            f"{counted(np.count_nonzero(bad_faces & ~few_corners), 'face')} left out: "
            f"{counted(np.count_nonzero(bad_points), 'vertex', 'vertices')} not finite",
        )
        geometry.points[0][bad_points] = 0.0
    if few_corners.any():
        report(
            geometry.name,
            f"{counted(np.count_nonzero(few_corners), 'face')} of less than three corners left out",
        )
    faces, corners = ~bad_faces, ~bad_faces[face_of_corner]
    keep = {"FACE": faces, "CORNER": corners}
    geometry.corner_verts = geometry.corner_verts[corners]
    if geometry.ngon_triangles is not None:
        large = geometry.face_sizes > 4
        kept = np.repeat(faces[large], geometry.face_sizes[large] - 2)
        geometry.ngon_triangles = np.ascontiguousarray(geometry.ngon_triangles[kept])
    geometry.face_sizes = geometry.face_sizes[faces]
    for name, mask in (("material_index", faces), ("smooth", faces), ("corner_normals", corners)):
        values = getattr(geometry, name)
        if values is not None:
            setattr(geometry, name, np.ascontiguousarray(values[mask]))
    for attribute in geometry.attributes:
        if attribute.domain in keep:
            attribute.values = np.ascontiguousarray(attribute.values[keep[attribute.domain]])
