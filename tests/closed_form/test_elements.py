# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves and points against closed forms (docs/hard_cases.md, cases 9, 13, 27 and 57)."""

import numpy as np
import pytest
import session_parts
import snapshots as s

import granita_core

OWEN_20_256 = 0.0035  # docs/sampling_error.md, edges moving 20 px at 256 samples


def curves(snapshot, points, sizes, radius, material=None, transforms=None, **extra):
    """points: [V,3] or [K,V,3]; radius: a number, [V] or [K,V]."""
    points = np.asarray(points, np.float32)
    points = points[None] if points.ndim == 2 else points
    radius = np.broadcast_to(
        np.atleast_2d(np.float32(radius)), (np.shape(np.atleast_2d(radius))[0], points.shape[1])
    )
    index = len(snapshot["geometries"])
    record = {"name": f"curves 'Curves {index}'", "kind": "CURVES", "points": points}
    record |= {
        "curve_sizes": np.array(sizes, np.int32),
        "radius": np.ascontiguousarray(radius),
        **extra,
    }
    snapshot["geometries"].append(record)
    s.instance(snapshot, index, material, transforms)


def cloud(snapshot, points, radius, material=None, transforms=None, **extra):
    points = np.asarray(points, np.float32)
    points = points[None] if points.ndim == 2 else points
    knots = np.shape(np.atleast_2d(radius))[0]
    radius = np.broadcast_to(np.atleast_2d(np.float32(radius)), (knots, points.shape[1]))
    index = len(snapshot["geometries"])
    record = {"name": f"points 'Points {index}'", "kind": "POINTS", "points": points}
    record["radius"] = np.ascontiguousarray(radius)
    snapshot["geometries"].append({**record, **extra})
    s.instance(snapshot, index, material, transforms)


# Standard errors of the sum: docs/sampling_error.md, of the narrowest that of independent samples, sqrt(A / n).
@pytest.mark.parametrize("width, error", [(0.02, 0.1639), (0.1, 0.248), (0.5, 0.210)])
def test_thin_line_keeps_its_energy(executor, width, error):
    """Case 9: alpha adds up to the area."""
    snapshot = s.orthographic((96, 64), samples=64, executor=executor)
    points = np.linspace((10.2, 7.3, 1), (83.7, 51.9, 1), 9)
    curves(snapshot, points, [9], width / 2, s.emission(snapshot))
    area = np.hypot(73.5, 44.6) * width
    assert abs(s.alpha(snapshot).sum() - area) < 4 * error


@pytest.mark.parametrize("perspective", [False, True])
@pytest.mark.parametrize("rate", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("radius, width", [(9.0, 1.2), (1.5, 0.6)])
def test_a_curl_that_runs_to_the_eye_is_a_ring(executor, radius, width, perspective, rate):
    """From its root to its tip it is seen as a point: how long it is in the picture, only its points tell."""
    options = {"executor": executor, "samples": 64, "dicing_rate": rate}
    angle = np.linspace(0, 4 * np.pi, 33)
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.ones(33)], 1)
    depth = np.linspace(30.0, 20.0, 33)[:, None]
    if perspective:
        snapshot = s.perspective((32, 32), 100.0, **options)
        curves(snapshot, ring * depth * [0.01, 0.01, 1], [33], depth[:, 0] * 0.01 * width / 2)
    else:
        snapshot = s.orthographic((32, 32), **options)
        curves(snapshot, ring * [1, 1, 0] + [16, 16, 0] + depth * [0, 0, 1], [33], width / 2)
    # Steps of the small one may be 3/100 of a pixel shorter than their arcs: eight a turn, between which a ribbon is
    # narrower by cos(pi / 8).  Measured: .094 less there, at most .03 of the large one.
    limit = 0.05 if radius > 5.0 else 0.12
    assert s.alpha(snapshot).sum() == pytest.approx(2 * np.pi * radius * width, rel=limit)


def sun_from(snapshot, angle, **extra):
    """A sun `angle` from the eye, beside what runs along x."""
    cos, sin = np.cos(angle), np.sin(angle)
    turned = np.eye(4)
    turned[:3, :3] = [[1, 0, 0], [0, -cos, sin], [0, -sin, -cos]]
    session_parts.sun(snapshot, turned, **extra)


def light_of_tubes(angle):
    """Mean over the width of tubes of albedo .8 that run along x."""
    across = np.linspace(-1, 1, 200001)
    facing = np.cos(angle) * np.sqrt(1 - across**2) + np.sin(angle) * across
    return np.maximum(0.0, facing).mean() * 0.8 * 3.0 / np.pi


def seen_light(result):
    picture = result["combined"]
    return picture[..., 0].sum() / picture[..., 3].sum()


@pytest.mark.parametrize("samples", [4, 16])
@pytest.mark.parametrize("angle", [0.0, 0.8])
def test_lit_hair_of_which_little_is_seen_costs_what_sees_it(angle, samples):
    """25 hairs of a fifth of a pixel across each pixel, in front of each other, in a sun that is `angle` from the eye: a
    tube across its width sends .8 / pi of the mean of max(0, n l).  From behind the eye what is seen is lit: shaded at
    points of the ribbons it had .88 of that, as rays from the normals' drawn-in places begin behind what is before.
    From elsewhere nothing casts shadows."""
    snapshot = s.orthographic((32, 32), executor="SIMD", samples=samples, light_samples=4)
    numbers, count = np.random.default_rng(1), 4000
    y, z = numbers.uniform(-2, 34, count), numbers.uniform(20, 50, count)
    x = np.linspace(-4, 36, 5)
    points = [np.broadcast_to(v, (count, 5)) for v in (x, y[:, None], z[:, None])]
    matte = session_parts.matte(snapshot, (0.8, 0.8, 0.8))
    curves(snapshot, np.stack(points, -1).reshape(-1, 3), [5] * count, 0.1, matte)
    sun_from(snapshot, angle, casts_shadow=angle == 0.0)
    result = s.render(snapshot)
    # Measured: 1.004, 1.005, .999, 1.003.
    assert seen_light(result) == pytest.approx(light_of_tubes(angle), rel=0.01)
    # The filter takes a pixel around the picture too.
    assert result["statistics"]["points_refined"] <= samples * 34 * 34
    assert result["statistics"]["points_shaded"] == result["statistics"]["points_refined"]


@pytest.mark.parametrize("angle", [-0.8, 0.8])
def test_narrow_hair_that_tapers_has_no_brighter_side(angle):
    """Steps of several pixels from a fifth of a pixel to a fiftieth of that: the triangle with the wide end is nearly
    all that is seen, and has its own side's normals."""
    snapshot = s.orthographic((32, 32), executor="SIMD", samples=16, light_samples=4)
    numbers, count = np.random.default_rng(1), 4000
    roots = np.stack([numbers.uniform(a, b, count) for a, b in ((-8, 32), (-2, 34), (20, 50))], -1)
    points = np.stack([roots, roots + [8, 0, 0]], 1).reshape(-1, 3)
    matte = session_parts.matte(snapshot, (0.8, 0.8, 0.8))
    curves(snapshot, points, [2] * count, np.tile([0.1, 0.002], count), matte)
    sun_from(snapshot, angle, casts_shadow=False)
    # Measured: 1.002, .996; with weights of triangles for places across the width .84 and 1.16.
    assert seen_light(s.render(snapshot)) == pytest.approx(light_of_tubes(angle), rel=0.01)


def test_thin_line_has_no_dashes(executor):
    """Case 9: along a horizontal hair every pixel holds the same share, with its own noise alone."""
    width, samples = 0.1, 256
    snapshot = s.orthographic((80, 16), samples=samples, executor=executor)
    curves(
        snapshot, [(-10, 8.5, 1), (40, 8.5, 1), (90, 8.5, 1)], [3], width / 2, s.emission(snapshot)
    )
    row = s.alpha(snapshot)[8]
    sigma = np.sqrt(width * (1 - width) / samples)
    assert abs(row.mean() - width) < 4 * sigma / np.sqrt(len(row))
    assert np.abs(row - width).max() < 4.5 * sigma


@pytest.mark.parametrize("radius", [0.3, 2.0, 15.0])
def test_point_is_a_disc(executor, radius):
    samples = 256
    snapshot = s.orthographic((48, 48), samples=samples, executor=executor)
    cloud(snapshot, [(23.7, 24.4, 20.0)], radius, s.emission(snapshot))
    alpha = s.alpha(snapshot)
    area = np.pi * radius**2
    # Only pixels on the outline, of which there are less than 8 r + 4, have an error at all.
    assert abs(alpha.sum() - area) < 4 * 0.5 * np.sqrt((8 * radius + 4) / samples)
    y, x = np.mgrid[:48, :48] + 0.5
    distance = np.hypot(x - 23.7, y - 24.4)
    assert alpha[distance < radius - 0.9].min(initial=1) == 1
    assert alpha[distance > radius + 0.9].max(initial=0) == 0


def test_moving_point_time_fraction(executor):
    """Cases 13 and 27: the part of the shutter during which a moving point covers a place."""
    radius, length = 10.0, 40.0
    expected = moving_disc((32, 80), (20.5, 16.5), radius, length)
    for motion in ("points", "object"):
        snapshot = s.orthographic((80, 32), samples=256, executor=executor)
        start = np.array([(20.5, 16.5, 15.0)])
        if motion == "points":
            cloud(snapshot, [start, start + (length, 0, 0)], radius, s.emission(snapshot))
        else:
            ends = [s.translation(0), s.translation(length)]
            cloud(snapshot, start, radius, s.emission(snapshot), ends)
        error = s.alpha(snapshot) - expected
        blurred = (expected > 0) & (expected < 1)
        assert np.sqrt(np.mean(error[blurred] ** 2)) <= 1.3 * OWEN_20_256
        assert np.abs(error).max() <= 4 * 2 * OWEN_20_256  # two edges pass each pixel


def moving_disc(shape, center, radius, length):
    """[h,w]: mean over each pixel of the time that a disc takes over a point, by 16 x 16 midpoints."""
    y, x = np.mgrid[: shape[0], : shape[1]].astype(float)
    total = np.zeros(shape)
    for oy in (np.arange(16) + 0.5) / 16:
        for ox in (np.arange(16) + 0.5) / 16:
            h = np.sqrt(np.maximum(radius**2 - (y + oy - center[1]) ** 2, 0))
            along = x + ox - center[0]
            time = np.minimum(along + h, length) - np.maximum(along - h, 0)
            total += np.maximum(time, 0) / length
    return total / 256


def test_moving_hair_is_a_moving_strip(executor):
    """An upright hair 2 px wide that crosses 20 px: a trapezoid, of which 2/20 is the plateau."""
    snapshot = s.orthographic((48, 16), samples=256, executor=executor)
    hair = np.array([(10.5, -20, 1), (10.5, 5, 1), (10.5, 30, 1)], float)
    curves(snapshot, [hair, hair + (20, 0, 0)], [3], 1.0, s.emission(snapshot))
    edge = lambda e: np.where(e < 0, 0, np.where(e > 1, e - 0.5, 0.5 * e * e))  # noqa: E731
    x = np.arange(48)
    left, right = 9.5 - x, 11.5 - x
    expected = ((edge(right + 20) - edge(right)) - (edge(left + 20) - edge(left))) / 20
    error = s.alpha(snapshot) - expected
    assert np.sqrt(np.mean(error[:, 8:34] ** 2)) <= 1.3 * OWEN_20_256
    assert abs(error[:, 8:34].mean()) < 4 * OWEN_20_256 / np.sqrt(16 * 26)


def test_radius_in_motion(executor):
    """A hair whose radius grows from 0 to 4 px: covers a place at distance d for 1 - d/4 of the time."""
    snapshot = s.orthographic((32, 16), samples=256, executor=executor)
    hair = np.array([(16, -20, 1), (16, 5, 1), (16, 30, 1)], float)
    curves(snapshot, [hair, hair], [3], np.repeat([[0.0], [4.0]], 3, axis=1), s.emission(snapshot))
    distance = np.abs(np.arange(32) + 0.5 - 16)
    expected = np.maximum(1 - distance / 4, 0)  # linear inside every pixel but the outermost
    error = s.alpha(snapshot) - expected
    inside = distance < 3.6
    assert (
        np.sqrt(np.mean(error[:, inside] ** 2)) <= 1.3 * 2 * 0.0035
    )  # two edges again; the rate of 5 to 20 px
    assert abs(error[:, inside].mean()) < 1e-3


def test_radius_of_a_point_in_motion(executor):
    """It grows from 0 to 8 px: covers a place at distance d for 1 - d/8 of the time."""
    snapshot = s.orthographic((24, 24), samples=256, executor=executor)
    center = np.array([(12, 12, 20)], float)
    cloud(snapshot, [center, center], [[0.0], [8.0]], s.emission(snapshot))
    x, y = np.meshgrid(np.arange(24) + 0.5 - 12, np.arange(24) + 0.5 - 12)
    distance = np.hypot(x, y)
    alpha = s.alpha(snapshot)
    inside = (distance > 1) & (distance < 7)  # nearly linear inside a pixel
    error = (alpha - (1 - distance / 8))[inside]
    # Four times what 256 samples leave of an edge that moves (docs/sampling_error.md).
    assert np.sqrt(np.mean(error**2)) <= 4 * 0.0055
    assert abs(alpha.sum() / (np.pi * 64 / 3) - 1) < 0.01


def scattered(snapshot, seed=5):
    """200 moving hairs and 200 moving points that overlap."""
    random = np.random.default_rng(seed)
    roots = random.uniform((0, 0, 5), (96, 64, 50), (200, 1, 3))
    hairs = (roots + np.cumsum(random.normal(0, 4, (200, 6, 3)), axis=1)).reshape(-1, 3)
    moved = hairs + random.normal(0, 3, 3)
    curves(
        snapshot,
        [hairs, moved],
        [6] * 200,
        random.uniform(0, 1.5, 1200),
        s.emission(snapshot, (1, 0.5, 0.2)),
    )
    points = random.uniform((0, 0, 5), (96, 64, 50), (200, 3))
    cloud(
        snapshot, [points, points + (5, 3, 0)], 1.2, s.emission(snapshot, (0.2, 0.5, 1), alpha=0.5)
    )


def test_no_bit_depends_on_buckets_threads_or_crop():
    def picture(**options):
        snapshot = s.orthographic((96, 64), samples=16, executor="SIMD", **options)
        scattered(snapshot)
        return s.render(snapshot)["combined"]

    whole = picture(bucket_size=64, threads=1)
    np.testing.assert_array_equal(whole, picture(bucket_size=16, threads=4))
    crop = picture(crop=(20, 10, 70, 50))
    np.testing.assert_array_equal(whole[10:50, 20:70], crop)


def test_executors_agree():
    pictures = []
    for executor in ("REFERENCE", "SIMD"):
        snapshot = s.orthographic((96, 64), samples=16, executor=executor)
        scattered(snapshot)
        pictures.append(s.render(snapshot)["combined"])
    np.testing.assert_allclose(*pictures, atol=1e-5)


def test_shared_outline_of_hair_and_mesh(executor):
    """A wide ribbon covers what a rectangle of its size covers, sample by sample."""
    pictures = []
    for kind in ("hair", "mesh"):
        snapshot = s.orthographic((64, 32), samples=16, executor=executor)
        if kind == "hair":
            points = [(10.25, 16, 1), (30.25, 16, 1), (50.25, 16, 1)]
            curves(snapshot, points, [3], 8.0, s.emission(snapshot))
        else:
            s.quad(snapshot, s.rectangle(10.25, 8, 50.25, 24), s.emission(snapshot))
        pictures.append(s.alpha(snapshot))
    np.testing.assert_array_equal(*pictures)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"curve_sizes": np.array([2], np.int32)}, "add up to 2"),
        ({"curve_sizes": np.array([0, 3], np.int32)}, "a curve of 0 points"),
        ({"radius": np.zeros((1, 2), np.float32)}, "radius"),
        ({"radius": np.zeros((3, 3), np.float32)}, "'radius' has 3 knots"),
        ({"kind": "BLOBS"}, "BLOBS"),
        ({"material_index": np.zeros(3, np.int32)}, "material_index"),
    ],
)
def test_wrong_curves_are_named(change, message):
    snapshot = s.orthographic((16, 16), samples=1)
    curves(snapshot, [(1, 1, 1), (5, 5, 1), (9, 9, 1)], [3], 1.0, s.emission(snapshot))
    snapshot["geometries"][0].update(change)
    with pytest.raises(granita_core.SceneError, match=message) as error:
        s.render(snapshot)
    assert "Curves 0" in str(error.value)
