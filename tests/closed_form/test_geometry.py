# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry that is hard to place, through the whole renderer (docs/hard_cases.md)."""

import numpy as np
import pytest
import snapshots as s

CUBE = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
CUBE_FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def test_ground_plane_under_the_camera(executor):
    """Case 47: a plane through the eye's foot; the horizon is at y = 0, nothing is missing below it."""
    snapshot = s.perspective((64, 64), 50.0, clip=(0.1, 1e6), samples=16, executor=executor)
    ground = [(-1e5, -1, -1e5), (1e5, -1, -1e5), (1e5, -1, 1e5), (-1e5, -1, 1e5)]
    s.quad(snapshot, ground, s.emission(snapshot))
    image = s.alpha(snapshot)
    assert image[:32].min() == 1.0  # rows below the horizon
    assert image[32:].max() == 0.0


def test_plane_from_behind_the_camera(executor):
    """A wall along the view direction that starts behind the eye covers exactly one side."""
    snapshot = s.perspective((64, 64), 50.0, clip=(0.01, 1e6), samples=16, executor=executor)
    wall = [(0.5, -1e3, -50), (0.5, -1e3, 1e5), (0.5, 1e3, 1e5), (0.5, 1e3, -50)]
    s.quad(snapshot, wall, s.emission(snapshot))
    image = s.alpha(snapshot)
    assert image[:, 33:].min() == 1.0
    assert image[:, :32].max() == 0.0


def test_closed_cube_has_no_pinholes(executor):
    """Case 50: white inside on black outside; every sample of the interior is covered."""
    snapshot = s.perspective((96, 96), 120.0, samples=64, executor=executor, grid_size=32)
    angle = 0.7
    turn = np.eye(4)
    turn[:3, :3] = [
        [np.cos(angle), 0.3 * np.sin(angle), np.sin(angle)],
        [0, 1, 0.4],
        [-np.sin(angle), 0.2, np.cos(angle)],
    ]
    turn[:3, 3] = (0, 0, 5)
    s.mesh(snapshot, CUBE, CUBE_FACES, s.emission(snapshot), transforms=[turn])
    image = s.alpha(snapshot)
    assert image[38:58, 38:58].min() == 1.0


def subdivided_cube(executor, **options):
    snapshot = s.perspective((96, 96), 200.0, samples=64, executor=executor, **options)
    s.mesh(
        snapshot,
        CUBE,
        CUBE_FACES,
        s.emission(snapshot),
        transforms=[s.translation(0, 0, 6)],
        subdivision={
            "scheme": "CATMULL_CLARK",
            "boundary": "ALL",
            "uv_smooth": "PRESERVE_BOUNDARIES",
        },
    )
    return s.alpha(snapshot)


def test_subdivision_surface_has_no_pinholes(executor):
    image = subdivided_cube(executor, grid_size=16)
    assert image[40:56, 40:56].min() == 1.0


def test_dicing_rate_changes_only_the_outline(executor):
    """A finer rate moves the silhouette by less than the stated chord error, not the inside."""
    coarse, fine = (
        subdivided_cube(executor, dicing_rate=1.0),
        subdivided_cube(executor, dicing_rate=0.25),
    )
    assert abs(coarse.sum() - fine.sum()) <= 2e-3 * fine.sum()
    inside = fine == 1.0
    assert np.mean(coarse[inside] == 1.0) > 0.99


def test_nan_vertices_are_left_out_and_named(executor):
    """Case 52: the rest of the picture does not change by a bit, the datablock is named."""

    def scene(bad):
        snapshot = s.orthographic((32, 32), samples=16, executor=executor)
        material = s.emission(snapshot)
        s.quad(snapshot, s.rectangle(4, 4, 20, 20), material)
        if bad:
            points = np.array(s.rectangle(10, 10, 30, 30, 0.5), float)
            points[2, 0] = np.nan
            s.quad(snapshot, points, material)
        return s.render(snapshot)

    clean, broken = scene(False), scene(True)
    assert np.array_equal(clean["combined"], broken["combined"])
    assert clean["warnings"] == []
    assert any(
        "Mesh 1" in datablock or "Object 1" in datablock for datablock, _, _ in broken["warnings"]
    )


@pytest.mark.parametrize("size", [(1, 1), (1, 33), (33, 1)])
def test_tiny_frames(executor, size):
    """Case 8."""
    snapshot = s.orthographic(
        size, samples=16, executor=executor, pixel_filter="MITCHELL", filter_width=4.0
    )
    s.quad(snapshot, s.rectangle(-50, -50, 90, 90), s.emission(snapshot))
    assert np.abs(s.alpha(snapshot) - 1).max() <= 1e-6


def test_edge_far_from_the_frame_origin(executor):
    """Case 8: the response of an edge at x = 16380.25 equals that at x = .25 up to sampling (other samples)."""

    def column(offset):
        snapshot = s.orthographic(
            (16384, 64),
            samples=256,
            executor=executor,
            crop=np.array((offset, 0, offset + 1, 64), np.int32),
        )
        s.quad(snapshot, s.rectangle(-10, -10, offset + 0.25, 100), s.emission(snapshot))
        return s.alpha(snapshot).mean()

    # 64 pixels of 256 stratified samples: each errs by less than 1/16 of a stratum's width in x.
    assert abs(column(16380) - 0.25) <= 4 * 0.5 / 256
    assert abs(column(0) - 0.25) <= 4 * 0.5 / 256


def test_far_over_near_of_ten_million(executor):
    """Case 60: depth order survives a clip range of 1e7."""
    snapshot = s.perspective((16, 16), 20.0, clip=(1e-3, 1e4), samples=16, executor=executor)
    near, far = s.emission(snapshot, (1, 0, 0)), s.emission(snapshot, (0, 1, 0))
    s.quad(
        snapshot,
        [(x * 9000, y * 9000, 9001.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
        far,
    )
    s.quad(
        snapshot,
        [(x * 9000, y * 9000, 9000.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
        near,
    )
    assert np.array_equal(s.render(snapshot)["combined"][8, 8], [1, 0, 0, 1])
