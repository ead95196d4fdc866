# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion, lens and transparency through OpenGL (docs/hard_cases.md): closed forms with the samples of REGULAR,
and the reference executor on the same samples."""

import numpy as np
import pytest
import snapshots as s
from moving_edge import add_moving_edge

REGULAR = {"sampling": "REGULAR", "executor": "RASTER"}


def render(snapshot):
    """The picture, drawn by OpenGL alone."""
    result = s.render(snapshot)
    statistics = result["statistics"]
    assert statistics["gl_primitives"] > 0
    assert statistics["sample_tests_static"] == statistics["sample_tests_moving"] == 0
    return result["combined"]


def both(make):
    """The same snapshot on the device and on the reference executor."""
    return render(make("RASTER")), s.render(make("REFERENCE"))["combined"]


def test_still_edge():
    """Case 1: an edge between sub-samples, box filter: the share of the pixel's columns."""
    snapshot = s.orthographic((16, 16), samples=64, **REGULAR)
    s.quad(snapshot, s.rectangle(-9, -9, 8.5, 30), s.emission(snapshot))
    alpha = render(snapshot)[..., 3]
    assert np.array_equal(alpha[:, :8], np.ones((16, 8)))
    assert np.abs(alpha[:, 8] - 0.5).max() <= 1e-6
    assert not alpha[:, 9:].any()


def rotated_lattice(side):
    """A lattice turned by atan(1 / side), for an even side: side x + y and side y - x are whole and a half."""
    u, v = np.meshgrid(np.arange(2 * side) + 0.5, np.arange(-side, side) + 0.5)
    x, y = (side * u - v) / (side**2 + 1), (u + side * v) / (side**2 + 1)
    inside = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    return np.stack([x[inside], y[inside]], -1)


@pytest.mark.parametrize("speed, passes", [(5, 16), (20, 64), (100, 256)])
def test_edge_moving_right(speed, passes):
    """Case 10, a lattice of 17 columns.  An instant's edge lies within half a column of where the lattice has it, and the
    passes are a midpoint rule: each pixel errs by at most half a column over the edge's way, and half a pass at either
    end of the pixel."""
    width = speed + 20
    snapshot = s.orthographic((width, 4), samples=16, time_samples=passes, **REGULAR)
    expected = add_moving_edge(snapshot, width, speed)
    error = np.abs(render(snapshot)[..., 3] - expected[None, :])
    # Each column is crossed once: its time is off by at most half a pass.
    assert error.max() <= 0.5 / passes + 1 / 34 / speed
    assert error[:, expected == 0].max() == error[:, expected == 1].max() == 0


def test_moving_disc_time_fraction():
    """Case 13: R = 10, L = 40."""
    radius, length, passes = 10.0, 40.0, 128
    snapshot = s.orthographic((80, 32), samples=16, time_samples=passes, **REGULAR)
    points, faces = s.disc(radius, (20.5, 16.5))
    move = [s.translation(0), s.translation(length)]
    s.mesh(snapshot, points, faces, s.emission(snapshot), transforms=move)
    x, y = np.meshgrid(np.arange(80) - 20.5, np.arange(32) - 16.5)
    expected = np.zeros_like(x)
    for px, py in rotated_lattice(4):  # at its own places: only time is sampled
        h = np.sqrt(np.maximum(radius**2 - (y + py) ** 2, 0))
        lo, hi = np.clip(x + px - h, 0, length), np.clip(x + px + h, 0, length)
        expected += (hi - lo) / length / 17
    error = np.abs(render(snapshot)[..., 3] - expected)
    # An interval's length in a midpoint rule errs by at most one pass; the polygon's outline by 2e-4 px.
    assert error.max() <= 1 / passes + 1e-4


def test_dolly_is_linear_before_projection():
    """Case 16: .27083 at radius 120 px."""
    passes = 256
    snapshot = s.perspective(
        (16, 4), 500.0, center=(-112.0, 2.0), samples=16, time_samples=passes, **REGULAR
    )
    points, faces = s.disc(1.0, z=0.0)
    move = [s.translation(0, 0, 10.0), s.translation(0, 0, 2.0)]
    s.mesh(snapshot, points, faces, s.emission(snapshot), transforms=move)
    image = render(snapshot)[..., 3]
    r = np.hypot(*np.meshgrid(112 + np.arange(16) + 0.5, np.arange(4) + 0.5 - 2))
    expected = 1 - (500.0 / r - 10.0) / (2.0 - 10.0)
    # One crossing a sample: half a pass; the mean of the pixel's places differs by the curvature of 1/r.
    assert np.abs(image - expected).max() <= 0.5 / passes + 1e-4
    assert abs(expected[:, 7:9].mean() - 0.27083) < 1e-3


def test_through_the_near_plane():
    """Case 17: z = 2 - 3 t, near .1: .6333."""
    passes = 256
    snapshot = s.perspective(
        (16, 4), 500.0, center=(-112.0, 2.0), samples=4, time_samples=passes, **REGULAR
    )
    points, faces = s.disc(1.0, z=0.0)
    move = [s.translation(0, 0, 2.0), s.translation(0, 0, -1.0)]
    s.mesh(snapshot, points, faces, s.emission(snapshot), transforms=move)
    assert np.abs(render(snapshot)[..., 3] - 1.9 / 3).max() <= 0.5 / passes


def stack(layers, **options):
    snapshot = s.orthographic((16, 16), **{"samples": 4, **REGULAR, **options})
    for z, a, color in layers:
        s.quad(snapshot, s.rectangle(-40, -40, 60, 60, z), s.emission(snapshot, color, a))
    return render(snapshot)


@pytest.mark.parametrize(
    "count, a, expected", [(128, 1 / 128, 0.6335623), (1000, 0.001, 0.6323046)]
)
def test_many_equal_layers(count, a, expected):
    """Case 35, to float rounding: n subtractions of 2^-24 relative error."""
    layers = [(1 + 0.01 * i, a, (1, 1, 1)) for i in range(count)]
    image = stack(layers, dicing_rate=16)  # flat: coarse dicing changes nothing
    assert np.abs(image[..., 3] - expected).max() <= count * 2.0**-24


def test_colours_front_to_back():
    """Case 35: colour of layer i is a (1 - a)^i c_i, whatever the order in which layers are given."""
    image = stack([(3, 0.5, (0, 0, 1)), (1, 0.5, (1, 0, 0)), (2, 0.5, (0, 1, 0))])
    assert np.abs(image - [0.5, 0.25, 0.125, 0.875]).max() <= 1e-6


def test_coincident_layers_both_count():
    """Case 40."""
    image = stack([(1, 0.3, (1, 1, 1)), (1, 0.6, (1, 1, 1))])
    assert np.abs(image[..., 3] - (1 - 0.7 * 0.4)).max() <= 1e-6


@pytest.mark.parametrize("bucket", [16, 64])
def test_opacity_threshold_is_exact(bucket):
    """Case 38: planes of .1 under the threshold .2 stop after the third layer (.271), as the paper's figure 9.5 has it
    on its right side."""
    layers = [(1 + i, 0.1, (1, 1, 1)) for i in range(20)]
    image = stack(layers, opacity_threshold=0.2, bucket_size=bucket)
    assert np.abs(image[..., 3] - 0.271).max() <= 1e-6


def test_z_batches_change_no_bit():
    scenes = [
        render(busy_scene("RASTER", z_batch_size=size, opacity_threshold=0.5))
        for size in (1, 10, 1000)
    ]
    assert np.array_equal(scenes[0], scenes[1]) and np.array_equal(scenes[0], scenes[2])


def test_z_batches_of_bent_strips_that_cross_change_no_bit():
    """Faces of a pixel, whose depths the rasterizer gets less exactly than their corners' are."""
    random = np.random.default_rng(7)
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, 3), np.linspace(-0.5, 0.5, 13))
    cells = (np.arange(12)[:, None] * 3 + np.arange(2)).reshape(-1, 1) + [0, 1, 4, 3]
    strips = []
    for _ in range(30):
        turn, bend = random.uniform(0, 2 * np.pi), random.uniform(4, 20)
        x, y, z = 16 * u, 80 * v, bend * np.cos(np.pi * v)
        place = random.uniform((0, 0, 230), (32, 32, 270))
        points = [x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn), z]
        strips.append((np.stack(points, -1).reshape(-1, 3) + place, random.uniform(0.1, 1, 3)))

    def picture(size):
        snapshot = s.orthographic(
            (32, 32), executor="RASTER", sampling="REGULAR", samples=16, z_batch_size=size
        )
        for points, color in strips:
            s.mesh(snapshot, points, cells.tolist(), s.emission(snapshot, color, 0.4))
        return s.render(snapshot)["combined"]

    whole = picture(65536)
    for size in (1, 10):
        assert np.array_equal(picture(size), whole)


def test_opaque_hides_what_is_behind():
    """Case 44 and M6."""
    front = [(1, 0.25, (1, 0, 0)), (2, None, (0, 1, 0))]
    behind = [(3, 0.5, (0, 0, 1)), (4, None, (1, 1, 1))]
    assert np.array_equal(stack(front), stack(front + behind))


def test_time_correlated_layers():
    """Case 41: covers [.2, .6] with .5 and [.1, .6] with .7: T = .59, not the .52 of blur-then-composite."""
    passes, length = 250, 1000.0
    options = {"samples": 4, "time_samples": passes, "dicing_rate": 32, **REGULAR}
    snapshot = s.orthographic((16, 16), **options)
    for t0, t1, z, a in [(0.2, 0.6, 1.0, 0.5), (0.1, 0.6, 2.0, 0.7)]:
        s.quad(
            snapshot,
            s.rectangle(8 - length * t1, -20, 8 - length * t0, 40, z),
            s.emission(snapshot, (1, 1, 1), a),
            transforms=[s.translation(0), s.translation(length)],
        )
    image = render(snapshot)[..., 3]
    # Each of four crossings is off by at most half a pass.
    assert np.abs(image[:, 7:9].mean() - 0.41) <= 4 * 0.5 / passes


@pytest.mark.parametrize("moving", [False, True], ids=["still", "moving"])
def test_diced_patch_has_no_seams(moving):
    """Case 42: the interior of a diced transparent patch is constant."""
    snapshot = s.perspective((64, 64), 60.0, samples=16, time_samples=5, grid_size=64, **REGULAR)
    points = [(-4, -4, 2), (4, -4, 4), (4, 4, 5), (-4, 4, 2.5)]
    ends = [s.translation(-0.1, 0.05), s.translation(0.1, -0.02)] if moving else None
    s.quad(snapshot, points, s.emission(snapshot, (1, 1, 1), 0.37), transforms=ends)
    image = render(snapshot)[24:40, 24:40, 3]
    assert np.abs(image - 0.37).max() <= 1e-6


def busy_scene(executor, lens=True, **options):
    """As the raster executor alone can have it: at six time samples."""
    return s.busy(executor, lens, **{"time_samples": 6, "sampling": "REGULAR", **options})


@pytest.mark.parametrize("lens", [False, True, "moving"], ids=["pinhole", "lens", "moving"])
@pytest.mark.parametrize("options", [{}, {"opacity_threshold": 0.3}], ids=["all", "threshold"])
def test_a_busy_scene_is_that_of_the_reference(lens, options):
    raster, reference = both(
        lambda executor: busy_scene(executor, lens, pixel_filter="BOX", filter_width=1.0, **options)
    )
    error = np.abs(raster - reference).max(axis=2)
    # A pixel has 6 x 17 samples; one may differ where an edge passes within a unit of 2^-8 texel, which is so for about
    # 2 x 2^-8 of a texel's width along the edges: a handful a thousand pixels.  Others agree to float rounding.  Of what
    # stands still a sample differs in all passes: 6 of 102.
    assert np.mean(error > 1e-5) < 0.1
    assert np.mean(error) < 1e-3
    assert error.max() < 7 / 102


@pytest.mark.parametrize(
    "change", [{"bucket_size": 16}, {"bucket_size": 128}, {"threads": 3}], ids=str
)
def test_buckets_and_threads_change_no_bit(change):
    base = render(busy_scene("RASTER"))
    assert np.ptp(base[..., 3]) > 0.5
    assert np.array_equal(base, render(busy_scene("RASTER", **change)))


@pytest.mark.parametrize("crop", [(0, 0, 96, 1), (13, 17, 64, 41)])
def test_crop_changes_no_bit(crop):
    whole = render(busy_scene("RASTER"))
    part = render(busy_scene("RASTER", crop=np.array(crop, np.int32)))
    assert np.array_equal(whole[crop[1] : crop[3], crop[0] : crop[2]], part)


LENSES = {"lens": True, "moving lens": "moving"}


@pytest.mark.parametrize("blur", ["still", "turning", "lens", "moving lens"])
def test_worlds_that_vary_are_those_of_the_reference(blur):
    """The world is evaluated at the corners of pixels and interpolated: exact to the second order of a pixel's angle,
    (1/90)^2 / 8 = 2e-5 rad of a gradient of slope .5 a radian; and once a pass where the camera turns or has a lens."""

    def make(executor):
        snapshot = busy_scene(
            executor, LENSES.get(blur, False), pixel_filter="BOX", filter_width=1.0
        )
        snapshot["options"]["film_transparent"] = False
        snapshot["world"] = {
            "name": "World",
            "nodes": [
                {"type": "ShaderNodeTexCoord", "inputs": {}},
                {
                    "type": "ShaderNodeBackground",
                    "inputs": {"Color": ("LINK", 0, "Generated"), "Strength": 0.5},
                },
            ],
            "surface": (1, "Background"),
            "lights_scene": False,
        }
        if blur == "turning":
            turn = s.translation(0)
            turn[0, 0] = turn[2, 2] = np.cos(0.3)
            turn[0, 2], turn[2, 0] = np.sin(0.3), -np.sin(0.3)
            snapshot["camera"]["world_from_camera"] = np.stack([np.eye(4), turn])
        return snapshot

    raster, reference = both(make)
    error = np.abs(raster - reference).max(axis=2)
    assert np.ptp(reference[..., 0]) > 0.2
    # As test_a_busy_scene: edges; everything else within the interpolation.
    assert np.mean(error > 2e-4) < 0.1
    assert np.mean(error) < 1e-3


@pytest.mark.parametrize("name, width", s.FILTERS.items())
@pytest.mark.parametrize("samples", [4, 9, 16])
def test_filters_of_a_turned_lattice_are_those_of_the_cpu(name, width, samples):
    """Colours and edges, none of which meets a sample within a unit of OpenGL's sub-pixel grid."""

    def scene(executor):
        options = {**REGULAR, "executor": executor, "samples": samples, "time_samples": 3}
        snapshot = s.orthographic((40, 30), pixel_filter=name, filter_width=width, **options)
        material = s.emission(snapshot, (0.2, 1.0, 3.0))
        move = [s.translation(0, 0), s.translation(2, 1)]
        s.quad(snapshot, s.rectangle(9.223, 7.327, 31.387, 20.463), material, transforms=move)
        return snapshot

    device, cpu = render(scene("RASTER")), s.render(scene("SIMD"))["combined"]
    assert np.abs(device - cpu).max() < 2e-5
