# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost follows need: what the statistics must show."""

import numpy as np
import pytest
import snapshots as s


def statistics(snapshot):
    return s.render(snapshot)["statistics"]


def layers(executor, order):
    snapshot = s.orthographic((96, 96), samples=16, executor=executor)
    material = s.emission(snapshot)
    for z in order:
        s.quad(snapshot, s.rectangle(-5, -5, 101, 101, 1.0 + z), material)
    return statistics(snapshot)


def test_hidden_layers_are_not_shaded(executor):
    """Ten opaque layers in shuffled order shade at most 1.3 times the front layer's points."""
    order = list(np.random.default_rng(3).permutation(10))
    front, all_layers = layers(executor, [0]), layers(executor, order)
    assert front["points_shaded"] > 90 * 90
    assert all_layers["points_shaded"] <= 1.3 * front["points_shaded"]


def sphere_cage():
    points = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return np.array(points, float), faces


def test_concentric_spheres_shade_the_outer_one(executor):
    def scene(radii):
        snapshot = s.perspective((96, 96), 150.0, samples=16, executor=executor)
        material = s.emission(snapshot)
        points, faces = sphere_cage()
        for radius in radii:
            s.mesh(
                snapshot,
                points * radius,
                faces,
                material,
                transforms=[s.translation(0, 0, 5)],
                subdivision={"scheme": "CATMULL_CLARK"},
            )
        return statistics(snapshot)

    outer, nested = scene([1.2]), scene([0.9, 1.2, 0.6, 1.05, 0.75])
    assert nested["points_shaded"] <= 1.3 * outer["points_shaded"]


def test_still_and_opaque_scenes_pay_for_neither_motion_nor_lists(executor):
    result = layers(executor, [0, 1])
    assert result["sample_tests_moving"] == 0
    assert result["buckets_moving"] == 0
    assert result["fragments_stored"] == 0
    assert result["buckets_transparent"] == 0
    assert result["rays_shadow"] == 0 and result["rays_occlusion"] == 0


def test_a_moving_thing_costs_motion_only_in_its_buckets(executor):
    snapshot = s.orthographic((256, 64), samples=16, executor=executor, bucket_size=32)
    material = s.emission(snapshot)
    s.quad(snapshot, s.rectangle(0, 0, 256, 64, 5), material)
    s.quad(
        snapshot,
        s.rectangle(4, 4, 20, 20),
        material,
        transforms=[s.translation(0), s.translation(6)],
    )
    result = statistics(snapshot)
    assert 1 <= result["buckets_moving"] <= 2


@pytest.mark.parametrize("size", [2, 10])
def test_what_a_moving_wall_always_hides_is_not_diced(size):
    """Sheets of faces fly along behind a wall: over the whole shutter they sweep past what the wall covers
    throughout, at no time do they pass its edge."""

    def scene(*parts):
        snapshot = s.orthographic((256, 64), samples=64, executor="SIMD")
        flight = [s.translation(0), s.translation(60)]
        if "wall" in parts:
            wall = s.rectangle(-60, -8, 180, 72, 1.0)
            s.quad(snapshot, wall, s.emission(snapshot, (1, 0, 0)), transforms=flight)
        if "sheets" in parts:
            x, y = np.meshgrid(np.arange(100, 151, size), np.arange(2, 63, size))
            row, green = x.shape[1], s.emission(snapshot, (0, 1, 0))
            faces = [
                (v, v + 1, v + row + 1, v + row) for v in range(x.size - row) if v % row < row - 1
            ]
            for z in range(2, 18):
                points = np.stack([x, y, np.full_like(x, z)], -1).reshape(-1, 3)
                s.mesh(snapshot, points, faces, green, transforms=flight)
        return s.render(snapshot)

    wall, sheets, both = scene("wall"), scene("sheets"), scene("wall", "sheets")
    assert (both["combined"] == wall["combined"]).all()
    wall, sheets, both = (r["statistics"] for r in (wall, sheets, both))
    assert both["primitives_culled_in_time"] > 0
    assert both["points_diced"] - wall["points_diced"] <= 0.1 * sheets["points_diced"]


@pytest.mark.parametrize("distance, bound", [(2000.0, 64), (1e6, 4)])
def test_far_objects_are_not_finely_diced(executor, distance, bound):
    """A cube of 2 m under a focal length of 2000 px: its faces are distance-limited to few micropolygons."""
    snapshot = s.perspective((64, 64), 2000.0, clip=(0.1, 1e9), samples=4, executor=executor)
    points, faces = sphere_cage()
    s.mesh(
        snapshot, points, faces, s.emission(snapshot), transforms=[s.translation(0, 0, distance)]
    )
    result = statistics(snapshot)
    # Projected side: 4000 / distance px. Six faces, at most (sqrt(2) * side)^2 + 1 micropolygons of 1 px each and double.
    assert result["points_diced"] <= 6 * 4 * bound


def test_a_grid_is_swept_once_however_many_buckets_hide_it(executor):
    snapshot = s.orthographic((96, 96), samples=4, executor=executor, bucket_size=16)
    # Grids of 16 pixels, off the borders of buckets by half of them.
    s.quad(snapshot, s.rectangle(8, 8, 88, 88, 5), s.emission(snapshot))
    result = statistics(snapshot)
    assert result["grids_swept"] == result["grids_diced"] > 1


def test_off_screen_geometry_is_never_opened(executor):
    snapshot = s.orthographic((32, 32), samples=4, executor=executor)
    material = s.emission(snapshot)
    s.quad(snapshot, s.rectangle(0, 0, 10, 10), material)
    near = statistics(snapshot)
    s.quad(snapshot, s.rectangle(1000, 1000, 9000, 9000), material)
    assert statistics(snapshot)["points_diced"] == near["points_diced"]


def test_many_samples_make_buckets_small():
    """A bucket holds 65,536 samples at most: of 256 a pixel four by four buckets instead of one."""

    def scene(samples, alpha=None):
        snapshot = s.orthographic((64, 64), samples=samples, executor="SIMD", bucket_size=64)
        moving = [s.translation(0), s.translation(8)]
        emission = s.emission(snapshot, alpha=alpha)
        s.quad(snapshot, s.rectangle(-9, 0, 64, 64, 5), emission, transforms=moving)
        return statistics(snapshot)

    for samples, buckets in ((16, 1), (64, 4), (256, 16), (1024, 16)):
        assert scene(samples)["buckets_moving"] == buckets
        assert scene(samples, alpha=0.5)["buckets_transparent"] == buckets
    assert scene(16)["buckets_transparent"] == 0


def regular(knots):
    snapshot = s.orthographic((16, 16), samples=1, sampling="REGULAR", executor="SIMD")
    points = s.rectangle(2, 2, 5, 5)
    moves = [s.translation(x) for x in knots]
    s.quad(snapshot, points, s.emission(snapshot), transforms=moves)
    return s.render(snapshot)


def test_regular_passes_follow_the_way_there_and_back():
    """As many as for the same way straight on; one where nothing moves."""

    def passes(*knots):
        return regular(knots)["statistics"]["samples_total"] / 256

    assert passes(0, 0) == 1
    assert passes(0, 1, 0) == passes(0, 2) > passes(0, 1) > 1


def test_more_passes_than_there_are_is_said():
    assert not regular((0, 1))["warnings"]
    made = regular((0, 1e5))
    assert made["statistics"]["samples_total"] == 128 * 256
    assert [m for _, m, _ in made["warnings"] if "stops at 128 time samples" in m]


@pytest.mark.parametrize("executor", ["REFERENCE", "SIMD", "COMPUTE", "RASTER"])
@pytest.mark.parametrize("crop", [(20, 9, 21, 10), (3, 5, 40, 33)])
def test_samples_are_those_of_the_crops_pixels(executor, crop):
    """Whatever tiles or cells the executor works in, and however far the filter reaches."""
    options = {"crop": np.array(crop, np.int32), "pixel_filter": "MITCHELL", "filter_width": 4.0}
    snapshot = s.orthographic((48, 48), samples=16, executor=executor, **options)
    s.quad(snapshot, s.rectangle(5, 5, 30, 30), s.emission(snapshot))
    pixels = (crop[2] - crop[0]) * (crop[3] - crop[1])
    assert statistics(snapshot)["samples_total"] == 16 * pixels
