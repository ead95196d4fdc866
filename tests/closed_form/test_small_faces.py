# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces of a pixel or less share grids and shading points; the picture stays that of the surface."""

import numpy as np
import pytest
import session_parts
import snapshots as s


def position_emission(snapshot):
    """A material that shines with its object-space position."""
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {
            "type": "ShaderNodeEmission",
            "inputs": {"Color": ("LINK", 0, "Object"), "Strength": 1.0},
        },
    ]
    index = len(snapshot["materials"])
    snapshot["materials"].append({"name": "Position", "nodes": nodes, "surface": (1, "Emission")})
    return index


def sheet(nx, ny, width, height, z=1.0):
    """Points and faces of nx x ny quads over a rectangle in pixels."""
    x, y = np.meshgrid(np.linspace(0, width, nx + 1), np.linspace(0, height, ny + 1))
    points = np.stack([x, y, np.full_like(x, z)], -1).reshape(-1, 3)
    v = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).reshape(-1, 1)
    return points, (v + np.array([0, 1, nx + 2, nx + 1])).tolist()


@pytest.mark.parametrize("size", [1.25, 0.8, 0.3])
def test_a_gradient_over_small_faces_keeps_its_place(executor, size):
    """Colours are constant over a point's faces: off by half of them, and right in the mean."""
    snapshot = s.orthographic((48, 32), executor=executor, samples=64)
    n = np.array([48, 32]) / size
    s.mesh(snapshot, *sheet(int(n[0]), int(n[1]), 48, 32), position_emission(snapshot))
    error = s.render(snapshot)["combined"][..., :2] - np.stack(
        np.meshgrid(np.arange(48) + 0.5, np.arange(32) + 0.5), -1
    )
    assert np.abs(error).max() < 0.75  # of a colour that grows by 1 a pixel
    assert np.abs(error.mean((0, 1))).max() < 0.03


@pytest.mark.parametrize("faces_a_pixel", [2, 1, 0.25])
def test_each_face_has_its_own_material(executor, faces_a_pixel):
    """Stripes of 4 pixels of two materials of one mesh, small faces and large ones; grids of sizes that do not
    divide the number of a material's faces."""
    snapshot = s.orthographic((32, 16), executor=executor, samples=4, grid_size=100)
    nx, ny = int(32 * faces_a_pixel), int(16 * faces_a_pixel)
    points, faces = sheet(nx, ny, 32, 16)
    stripe = np.arange(nx) * 8 // nx % 2
    red, green = s.emission(snapshot, (1, 0, 0)), s.emission(snapshot, (0, 1, 0))
    index = np.tile(stripe, ny).astype(np.int32)
    s.mesh(snapshot, points, faces, red, material_index=index)
    snapshot["instances"]["slots"] = [2]
    snapshot["instances"]["materials"] = [red, green]
    picture = s.render(snapshot)["combined"]
    first = np.arange(32) // 4 % 2 == 0
    assert np.array_equal(picture[..., 0], np.tile(first, (16, 1)))
    assert np.array_equal(picture[..., 1], np.tile(~first, (16, 1)))


def test_points_follow_the_pixels():
    """250,000 quads at 160 x 90 are 17 a pixel."""
    snapshot = s.orthographic((160, 90), executor="SIMD", samples=16)
    s.mesh(snapshot, *sheet(667, 375, 160, 90), s.emission(snapshot))
    result = s.render(snapshot)
    assert (result["combined"] == 1.0).all()
    assert result["statistics"]["points_shaded"] <= 2 * 160 * 90
    assert result["statistics"]["grids_diced"] <= 2 * 667 * 375 / 256


def test_small_faces_cover_what_one_face_covers(executor):
    def render(nx, ny):
        snapshot = s.orthographic((40, 24), executor=executor, samples=16)
        points, faces = sheet(nx, ny, 31, 17)
        points = points + [4.25, 3.5, 0]
        motion = [s.translation(-2.5, 1.0), s.translation(2.5, -1.0)]
        s.mesh(snapshot, points, faces, s.emission(snapshot, alpha=0.5), transforms=motion)
        return s.alpha(snapshot)

    assert (
        np.abs(render(62, 34) - render(1, 1)).max() <= 1 / 64
    )  # half an alpha of samples on edges


@pytest.mark.parametrize(
    "change", [{"bucket_size": 16}, {"threads": 3}, {"crop": np.int32([13, 7, 41, 30])}], ids=str
)
@pytest.mark.parametrize("is_lit", [False, True], ids=["shining", "lit"])
def test_buckets_threads_and_crop_change_no_bit(executor, change, is_lit):
    def render(**options):
        snapshot = s.perspective((64, 48), 90.0, executor=executor, samples=16, **options)
        points, faces = sheet(100, 80, 2.0, 1.6)
        x, y = points[:, 0] - 1.0, points[:, 1] - 0.8
        waves = np.stack([x, y, 3.0 + 0.3 * np.sin(7 * x) * np.cos(9 * y)], -1)
        moved = waves + [0.1, 0.05, -0.2]
        material = matte(snapshot) if is_lit else position_emission(snapshot)
        s.mesh(snapshot, np.stack([waves, moved]), faces, material)
        snapshot["lights"] = [area_lamp((1, 2, -3), (-0.2, -0.3, 1), 2.0)] * is_lit
        return s.render(snapshot)["combined"]

    base = render()
    if "crop" in change:
        x0, y0, x1, y1 = change["crop"]
        base = base[y0:y1, x0:x1]
    assert np.ptp(base[..., 3]) > 0.5 or "crop" in change
    assert np.array_equal(base, render(**change))


@pytest.mark.parametrize("ends", [(0.0, 0.0), (-1.0, 1.5)], ids=["still", "moving"])
def test_opengl_draws_the_same_small_faces(ends):
    def render(executor):
        options = {"sampling": "REGULAR", "samples": 16, "time_samples": 4}
        snapshot = s.orthographic((48, 32), executor=executor, **options)
        points, faces = sheet(60, 39, 40, 26)
        s.mesh(
            snapshot,
            points + [3.22, 2.76, 0],  # no edge within 2^-8 texel of a sample
            faces,
            position_emission(snapshot),
            transforms=[s.translation(x, 0.5 * x) for x in ends],
        )
        return s.render(snapshot)

    raster, cpu = render("RASTER"), render("SIMD")
    assert raster["statistics"]["gl_primitives"] > 0
    assert raster["statistics"]["points_shaded"] == cpu["statistics"]["points_shaded"]
    assert np.abs(raster["combined"] - cpu["combined"]).max() < 1e-4


def test_what_small_faces_hide_is_not_shaded():
    """A ball of faces of half a pixel: its back costs nothing."""
    n = 200
    latitude, longitude = np.meshgrid(
        np.linspace(-np.pi / 2, np.pi / 2, n // 2), np.linspace(0, 2 * np.pi, n), indexing="ij"
    )
    points = np.stack(
        [
            24 + 20 * np.cos(latitude) * np.cos(longitude),
            24 + 20 * np.cos(latitude) * np.sin(longitude),
            50 + 20 * np.sin(latitude),
        ],
        -1,
    ).reshape(-1, 3)
    v = (np.arange(n // 2 - 1)[:, None] * n + np.arange(n - 1)).reshape(-1, 1)
    snapshot = s.orthographic((48, 48), executor="SIMD", samples=16)
    faces = (v + np.array([0, 1, n + 1, n])).tolist()
    s.mesh(snapshot, points, faces, s.emission(snapshot))
    result = s.render(snapshot)
    # The half in front has twice its outline's area; towards the outline points crowd.
    assert result["statistics"]["points_shaded"] <= 2.5 * np.pi * 20**2


def ball(radius, across=32, down=16):
    """Points and faces of a sphere about the origin, poles along z."""
    polar = np.linspace(0.0, np.pi, down + 1)[:, None]
    round_ = np.arange(across)[None] * 2 * np.pi / across
    rings = np.stack(
        [
            np.sin(polar) * np.cos(round_),
            np.sin(polar) * np.sin(round_),
            np.cos(polar) + 0 * round_,
        ],
        -1,
    )
    v = np.arange(across)
    w = (v + 1) % across
    quads = [np.stack([v, w, w + across, v + across], 1) + r * across for r in range(1, down - 1)]
    top = np.stack([0 * v, w + across, v + across], 1)
    bottom = np.stack([v + (down - 1) * across, w + (down - 1) * across, 0 * v + down * across], 1)
    faces = [f.tolist() for f in np.concatenate(quads)] + top.tolist() + bottom.tolist()
    return radius * rings.reshape(-1, 3), faces


@pytest.mark.parametrize("frame_time", [0.0, 0.5, 1.0])
def test_a_ball_that_turns_does_not_shadow_itself(frame_time):
    """About the axis that it is seen along: its points go round with their faces, so it is lit as if it stood."""

    def render(angle):
        snapshot = s.orthographic(
            (16, 16), executor="SIMD", samples=16, light_samples=16, frame_time=frame_time
        )
        turns = [s.translation(8, 8, 20) for _ in range(9)]
        for turn, a in zip(turns, angle * (np.linspace(0, 1, 9) - frame_time)):
            turn[:2, :2] = [[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]
        s.mesh(snapshot, *ball(6.0), matte(snapshot), transforms=turns)
        tilt = np.eye(4)
        tilt[:3, :3] = [[0.8, 0, -0.6], [0, -1, 0], [-0.6, 0, -0.8]]  # shines along (.6, 0, .8)
        session_parts.sun(snapshot, tilt)
        return s.render(snapshot)["combined"][5:11, 5:11, 0]

    still, turning = render(0.0), render(0.7)
    assert still.mean() > 0.3
    assert turning.mean() == pytest.approx(still.mean(), rel=0.02)


def matte(snapshot):
    return session_parts.matte(snapshot, (0.8, 0.8, 0.8))


def area_lamp(place, axis, size, **extra):
    """Shines along `axis`."""
    world = np.eye(4)
    z = -np.asarray(axis, float) / np.linalg.norm(axis)
    x = np.cross([0.0, 1.0, 0.1], z)
    x /= np.linalg.norm(x)
    world[:3, :3] = np.stack([x, np.cross(z, x), z], 1)
    world[:3, 3] = place
    lamp = {"name": "Lamp", "kind": "AREA", "world_from_light": world[None], "energy": 1e5}
    return {**lamp, "size": (size, size), **extra}


@pytest.mark.parametrize("size", [0.8, 1.5, 2.5, 4.0, 6.0])
def test_bent_faces_do_not_shadow_themselves(size):
    """No slope of a wavy sheet is as steep as any ray to the lamp above it: all rays get there.  Quads are bent by
    as much as the sheet is, here and there, and rays meet them as two triangles."""

    def render(casts_shadow):
        snapshot = s.orthographic((48, 32), executor="SIMD", samples=16, light_samples=16)
        points, faces = sheet(int(48 / size), int(32 / size), 48, 32)
        x, y = points[:, 0], points[:, 1]
        points[:, 2] = 50.0 + 2.0 * np.sin(0.2 * x) * np.cos(0.25 * y)
        s.mesh(snapshot, points, faces, matte(snapshot))
        snapshot["lights"] = [area_lamp((24, 16, -30), (0, 0, 1), 20.0, casts_shadow=casts_shadow)]
        return s.render(snapshot)["combined"]

    lit = render(False)
    assert lit[..., 0].min() > 0.1
    # A ray of sixteen is 6 % of a corner's light; those that agree are added in another order.
    assert np.allclose(render(True), lit, rtol=1e-6, atol=0)


@pytest.mark.parametrize("shape", ["quads", "triangles", "bent quads"])
def test_lit_faces_have_the_colours_of_their_corners(shape):
    """Coloured by place, under a sun straight above: each sample by where it is."""
    snapshot = s.orthographic(
        (24, 16),
        executor="SIMD",
        samples=64,
        sampling="REGULAR",
        pixel_filter="BOX",
        filter_width=1.0,
    )
    points, faces = sheet(40, 27, 1.0, 2 / 3)
    if shape == "triangles":
        faces = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    if shape == "bent quads":
        points[:, 2] += np.where(np.arange(len(points)) % 2 == 1, 0.005, 0.0)
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": ("LINK", 0, "Object")}},
    ]
    snapshot["materials"].append({"name": "Place", "nodes": nodes, "surface": (1, "BSDF")})
    larger = np.diag([24.0, 24.0, 24.0, 1.0])
    s.mesh(snapshot, points, faces, 0, transforms=[larger])
    session_parts.sun(snapshot, energy=np.pi)
    result = s.render(snapshot)
    assert result["statistics"]["points_refined"] >= 24 * 16 * 64
    x, y = np.meshgrid((np.arange(24) + 0.5) / 24, (np.arange(16) + 0.5) / 24)
    expected = np.stack([x, y], -1)
    tilt = 1.0
    if shape == "bent quads":  # each triangle by the same angle
        tilt = (result["combined"][..., :2] / expected).mean()
        assert 0.9 < tilt < 0.999
    off = result["combined"][..., :2] - tilt * expected
    assert np.abs(off).max() < (2e-3 if shape == "bent quads" else 2e-5)


def confetti(count, size, width, height, depth, seed=1):
    """Points and faces of `count` squares across the z axis, of `size` each."""
    numbers = np.random.default_rng(seed)
    centers = numbers.uniform((0, 0, 20), (width, height, 20 + depth), (count, 3))
    around = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * size / 2
    points = (centers[:, None] + around).reshape(-1, 3)
    return points, np.arange(4 * count).reshape(-1, 4).tolist()


@pytest.mark.parametrize("samples", [4, 16])
def test_lit_faces_of_which_few_are_seen_cost_what_sees_them(samples):
    """A hundred squares a pixel, in front of each other, in the light of a sun behind the eye: what is seen is lit, and
    has .8 / pi of the sun's 3.  Shaded where what stands together is in the mean, in its own shadow, they had .59 of it,
    and cost 14 points a pixel with 4 samples."""
    snapshot = s.orthographic((48, 32), executor="SIMD", samples=samples, light_samples=4)
    s.mesh(snapshot, *confetti(48 * 32 * 100, 0.3, 48, 32, 40), matte(snapshot))
    session_parts.sun(snapshot)
    result = s.render(snapshot)
    radiance, alpha = result["combined"][..., 0], result["combined"][..., 3]
    assert alpha.mean() > 0.98
    # Of 120 pixels of edges in a pixel, one is within a rounding of a sample in one of 4,000.
    is_right = np.isclose(radiance, alpha * 0.8 * 3.0 / np.pi, rtol=1e-4)
    assert np.count_nonzero(~is_right) <= 2.5e-3 * samples * is_right.size / 4
    assert radiance.mean() == pytest.approx(alpha.mean() * 0.8 * 3.0 / np.pi, rel=1e-3)
    # The filter takes a pixel around the picture too.
    assert result["statistics"]["points_shaded"] <= samples * 50 * 34


def wall_of_slivers(wide, high=1.5, **options):
    """48 x 32 pixels of faces `high` pixels high and `wide` pixels wide, in a soft shadow."""
    options = {"executor": "SIMD", "samples": 16, "light_samples": 16} | options
    snapshot = s.orthographic((48, 32), **options)
    x, y = np.arange(0.0, 48.0 + wide / 2, wide), np.arange(0.0, 31.5 + high / 2, high)
    points = np.array([(a, b, 20.0) for b in y for a in x])
    corners = np.arange(len(points)).reshape(len(y), len(x))
    quads = [corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]]
    s.mesh(snapshot, points, np.stack(quads, -1).reshape(-1, 4).tolist(), matte(snapshot))
    snapshot["lights"] = [area_lamp((24, 16, -30), (0, 0, 1), 20.0)]
    s.quad(snapshot, s.rectangle(20, 12, 28, 20, -5.0), 0)  # behind the eye
    result = s.render(snapshot)
    return result["combined"][2:-2, 2:-2, 0], result["statistics"]["rays_shadow"]


@pytest.mark.parametrize("wide", [0.05, 0.02])
def test_points_of_slivers_have_no_more_light_samples_than_pixels_need(wide):
    """A pixel has 80 and 200 points of them.  With all light samples of a pixel each they took 20 and 22 times the rays of
    faces of 1.5 by 1.5 pixels; now, for the same noise, .034 and .029 for .034, 11 times."""
    exact, _ = wall_of_slivers(1.5, light_samples=1024)
    assert exact.min() < 0.5 * exact.max()
    squares, rays_of_squares = wall_of_slivers(1.5)
    slivers, rays = wall_of_slivers(wide)
    assert slivers.mean() == pytest.approx(exact.mean(), rel=4e-3)
    assert np.std(slivers - exact) < 1.3 * np.std(squares - exact)
    assert rays < 14 * rays_of_squares


def test_points_of_a_finer_dicing_rate_keep_their_light_samples():
    """They were asked for.  Noise of .59 of that of a pixel's points; with fewer samples (15 of 16) .81."""
    faces = {"wide": 12.0, "high": 10.5, "samples": 64, "shading_threshold": 1000}
    exact, _ = wall_of_slivers(**faces, light_samples=1024)
    of_pixels, _ = wall_of_slivers(**faces)
    fine, _ = wall_of_slivers(**faces, dicing_rate=0.5)
    assert np.std(fine - exact) < 0.7 * np.std(of_pixels - exact)


def dented_ball(across, size, **options):
    """Grey picture of `size` x `size` pixels, lit from the side by a lamp twice the ball's size."""
    snapshot = s.orthographic((size, size), executor="SIMD", **options)
    scale = size / 64.0
    points, faces = ball(28.0 * scale, across, across * 2 // 3)
    x, y, z = points.T / (28.0 * scale)
    points *= (1 + 0.04 * np.sin(9 * x) * np.sin(8 * y + 1) * np.sin(7 * z))[:, None]
    middle = scale * np.array([32.0, 32.0, 100.0])
    s.mesh(snapshot, points, faces, matte(snapshot), transforms=[s.translation(*middle)])
    way = scale * np.array([110.0, 14.0, 30.0])
    lamp = area_lamp(way + middle, -way, 55.0 * scale, energy=1e6 * scale**2)
    snapshot["lights"] = [lamp]
    return s.render(snapshot)["combined"][..., 0]


@pytest.mark.parametrize("across", [30, 60])
def test_small_faces_in_grazing_light_have_no_specks(across):
    """Of 6 and 3 pixels: 16 light samples against 1024.  What a batch's mean share of them left its larger faces was off
    by a third of the light (.09 and .22 in one of a thousand pixels)."""
    # Of corners: samples that are shaded by themselves have a light sample each.
    options = {"samples": 32, "shading_threshold": 1000}
    error = np.abs(
        dented_ball(across, 64, light_samples=16, **options)
        - dented_ball(across, 64, light_samples=1024, **options)
    )
    # Measured: .0216, .0251.
    assert np.quantile(error, 0.999) < 0.04


@pytest.mark.parametrize("across", [150, 300])
def test_faces_below_a_pixel_converge(across):
    """Against the same ball four times as large, whose faces are pixels wide.  Shaded where pixels of them are in the
    mean they were off by .025 and .033 (RMSE), however many samples there were."""
    options = {"samples": 256, "light_samples": 16, "pixel_filter": "BOX", "filter_width": 1.0}
    large = dented_ball(across, 256, **{**options, "samples": 64})
    large = large.reshape(64, 4, 64, 4).mean(axis=(1, 3))
    error = np.sqrt(np.mean((dented_ball(across, 64, **options) - large) ** 2))
    assert error < 0.008  # measured: .0057, .0042


def torus(across, radius=19.0, thickness=4.75):
    """Points and faces about the origin, twice as many around as across the tube."""
    around = np.arange(across) * 2 * np.pi / across
    tube = np.arange(across // 2) * 4 * np.pi / across
    a, b = np.meshgrid(around, tube, indexing="ij")
    far = radius + thickness * np.cos(b)
    points = np.stack([far * np.cos(a), far * np.sin(a), thickness * np.sin(b)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(across), np.arange(across // 2), indexing="ij")
    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
    v = [(p % across) * (across // 2) + q % (across // 2) for p, q in corners]
    return points, np.stack(v, -1).reshape(-1, 4).tolist()


def turned(angle):
    return np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )


MOTIONS = {
    "grows": [np.eye(3) * x for x in (0.75, 1.25)],
    "is stretched": [np.diag([x, 1.0, 1.0]) for x in (0.8, 1.0, 1.2)],
    "turns": [turned(x) for x in np.linspace(-0.3, 0.3, 9)],
    "turns on chords": [turned(-0.3), turned(0.3)],
}


@pytest.mark.parametrize("deforms", [False, True])
@pytest.mark.parametrize("across", [48, 96, 300])
@pytest.mark.parametrize("motion", MOTIONS)
def test_what_moves_does_not_shadow_itself(motion, across, deforms):
    """A torus in a sun that is high above it: no ray to it meets the torus, however it is stretched."""

    def render(casts_shadow):
        snapshot = s.orthographic((64, 64), executor="SIMD", samples=64, light_samples=16)
        points, faces = torus(across)
        knots = MOTIONS[motion]
        transforms = [s.translation(32, 32, 50) for _ in knots]
        if deforms:
            points = np.stack([points @ matrix.T for matrix in knots])
        else:
            for transform, matrix in zip(transforms, knots):
                transform[:3, :3] = matrix
        s.mesh(snapshot, points, faces, matte(snapshot), transforms=transforms)
        lamp = area_lamp((0, 0, 0), (14, 10, 30), 1.0, casts_shadow=casts_shadow)
        snapshot["lights"] = [{**lamp, "kind": "SUN", "energy": 3.0}]
        return s.render(snapshot)["combined"][..., 0]

    lit = render(False)
    shadow = lit - render(True)
    # Measured: .017 and 2.4e-4 where it turns on chords, on which it shrinks; elsewhere .003 and 4e-5.
    assert shadow.max() < 0.04 and shadow.mean() < 5e-4 * lit.mean()


@pytest.mark.parametrize("triangles", [False, True])
@pytest.mark.parametrize("part", [1e-3, 0.25, 2.0])
def test_lines_cover_a_part_of_small_faces(executor, part, triangles):
    """Lines of a triangle's edges leave a triangle whose inscribed circle is smaller by half of their width."""
    side = 0.4
    inscribed = side * (1 - 0.5**0.5)
    snapshot = s.orthographic((24, 16), executor=executor, samples=4)
    nodes = [
        {"type": "ShaderNodeWireframe", "inputs": {"Size": 2 * part * inscribed}},
        {"type": "ShaderNodeEmission", "inputs": {"Color": ("LINK", 0, "Fac"), "Strength": 1.0}},
    ]
    snapshot["materials"].append({"name": "Wire", "nodes": nodes, "surface": (1, "Emission")})
    points, faces = sheet(62, 42, 62 * side, 42 * side)
    if triangles:
        faces = [half for a, b, c, d in faces for half in [(a, b, c), (a, c, d)]]
    s.mesh(snapshot, points, faces, 0)
    expected = 1 - max(0, 1 - part) ** 2
    np.testing.assert_allclose(s.render(snapshot)["combined"][..., 0], expected, atol=2e-4)


@pytest.mark.parametrize("see_through", [False, True])
@pytest.mark.parametrize("side", [0.9, 2.0, 5.0])
def test_lines_between_corners_of_micropolygons(side, see_through):
    """Of faces of a few micropolygons, whose corners lie on edges."""
    part = 0.05
    snapshot = s.orthographic((48, 32), executor="SIMD", samples=64)
    size = 2 * part * side * (1 - 0.5**0.5)
    color = (1.0,) * 4 if see_through else ("LINK", 0, "Fac")
    nodes = [
        {"type": "ShaderNodeWireframe", "inputs": {"Size": size}},
        {"type": "ShaderNodeEmission", "inputs": {"Color": color, "Strength": 1.0}},
        {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1.0, 1.0, 1.0, 1.0)}},
    ]
    links = {"Fac": (0, "Fac"), "Shader": (2, "BSDF"), "Shader_001": (1, "Emission")}
    mixed = {name: ("LINK", *link) for name, link in links.items()}
    nodes.append({"type": "ShaderNodeMixShader", "inputs": mixed})
    surface = (3, "Shader") if see_through else (1, "Emission")
    snapshot["materials"].append({"name": "Wire", "nodes": nodes, "surface": surface})
    points, faces = sheet(60, 40, 60 * side, 40 * side)
    s.mesh(snapshot, points, faces, 0)
    seen = s.render(snapshot)["combined"]
    expected = 1 - (1 - part) ** 2
    # 98,000 samples: 3 deviations are 0.003 and more, were they random; parts of faces at the frame's end besides.
    assert seen[..., 0].mean() == pytest.approx(expected, abs=0.004)
    assert seen[..., 3].mean() == pytest.approx(expected if see_through else 1.0, abs=0.004)
