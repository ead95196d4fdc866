# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of which only some faces bound a volume."""

import numpy as np
import pytest
import snapshots as s
from test_volumes import SIGMA, absorption, box, filled, mean, view, wall


def partly_filled(low, high, opaque, extra=(), change=None):
    """A view of a box whose face `opaque` (0 the near one, 1 the far one) shines where the others bound an absorber; of one
    mesh with it are quadrilaterals `extra`, of the same shine."""
    snapshot = view()
    wall(snapshot)
    shine, fog = s.emission(snapshot), filled(snapshot, absorption())
    index = box(snapshot, (-1, -1, low), (20, 20, high), fog)
    mesh, table = snapshot["geometries"][index], snapshot["instances"]
    table["slots"][-1], table["materials"][-1:] = 2, [fog, shine]
    for corners in extra:
        count = mesh["points"].shape[1]
        mesh["points"] = np.append(mesh["points"], np.float32(corners)[None], 1)
        mesh["face_sizes"] = np.append(mesh["face_sizes"], np.int32(4))
        mesh["corner_verts"] = np.append(mesh["corner_verts"], count + np.arange(4, dtype=np.int32))
    shines = np.zeros(len(mesh["face_sizes"]), np.int32)
    shines[6:] = 1
    if opaque is not None:
        shines[opaque] = 1
    mesh["material_index"] = shines
    if change:
        change(mesh)
    return mean(snapshot)


def test_a_thing_may_be_bounded_by_faces_without_volume():
    """What is not entered is not there, and a face without volume is met from inside of what others bound."""
    assert partly_filled(2, 5, 0) == pytest.approx(1.0, rel=1e-5)
    assert partly_filled(2, 5, 1) == pytest.approx(np.exp(-3 * SIGMA), rel=1e-5)
    assert partly_filled(-4, 5, 1) == pytest.approx(np.exp(-(5 - 0.01) * SIGMA), rel=1e-5)


def test_faces_that_share_places_but_no_vertices_are_of_one_piece():
    """As files have them whose normals or materials break at edges."""

    def split(mesh):
        mesh["points"] = mesh["points"][:, mesh["corner_verts"]]
        mesh["corner_verts"] = np.arange(len(mesh["corner_verts"]), dtype=np.int32)

    assert partly_filled(2, 5, 0, change=split) == pytest.approx(1.0, rel=1e-5)


def test_a_wall_within_what_is_filled_hides_no_side_of_it():
    """It is welded to the box's sides, and its front faces the camera inside: what is before it is filled."""

    def divide(mesh):
        z = mesh["points"][0, :, 2]
        low, high = np.flatnonzero(z == z.min()), np.flatnonzero(z == z.max())
        middle = mesh["points"][:, low].copy()
        middle[..., 2] = 3.0
        count = mesh["points"].shape[1]
        at = {int(v): count + i for i, v in enumerate(low)}
        # The box's sides are cut where the wall meets them.
        above = dict(zip(low.tolist(), high.tolist()))
        faces, corner = [], 0
        for size in mesh["face_sizes"]:
            verts = [int(v) for v in mesh["corner_verts"][corner : corner + size]]
            corner += size
            down = [v for v in verts if v in at]
            if len(down) != 2:
                faces.append(verts)
                continue
            faces.append(
                [v if v in at else at[next(k for k in above if above[k] == v)] for v in verts]
            )
            faces.append([at[v] if v in at else v for v in verts])
        near = next(f for f in faces if all(v in at for v in f))
        wall = [at[v] for v in near]
        mesh["points"] = np.append(mesh["points"], middle, 1)
        mesh["face_sizes"] = np.full(len(faces) + 1, 4, np.int32)
        mesh["corner_verts"] = np.array([v for f in [*faces, wall] for v in f], np.int32)
        mesh["material_index"] = np.array([0] * len(faces) + [1], np.int32)

    seen = partly_filled(-4, 5, None, change=divide)
    assert seen == pytest.approx(np.exp(-(3 - 0.01) * SIGMA), rel=1e-5)


@pytest.mark.parametrize("turned", [False, True])
def test_what_is_of_one_mesh_but_not_of_one_piece_tells_of_no_volume(turned):
    """A wall that stands apart, seen from either side: within the box, and beyond it."""
    for low, z, passed in [(-4, 3, 3 - 0.01), (8, 3, 0.0)]:
        corners = s.rectangle(-1, -1, 20, 20, z)
        corners = corners[::-1] if turned else corners
        seen = partly_filled(low, low + 9, None, [corners])
        assert seen == pytest.approx(np.exp(-passed * SIGMA), rel=1e-5)
