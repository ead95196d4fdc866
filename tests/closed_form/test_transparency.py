# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of transparency against closed forms (docs/hard_cases.md)."""

import hypothesis
import hypothesis.strategies as st
import numpy as np
import pytest
import snapshots as s


def stack_of(executor, layers, world=None, **options):
    """layers: (z, alpha, colour); each covers the frame, before a white world of that strength."""
    snapshot = s.orthographic((16, 16), samples=16, executor=executor, **options)
    for z, a, color in layers:
        s.quad(snapshot, s.rectangle(-40, -40, 60, 60, z), s.emission(snapshot, color, a))
    if world is not None:
        s.constant_world(snapshot, world)
    return snapshot


def stack(executor, layers, **options):
    return s.render(stack_of(executor, layers, **options))["combined"]


@pytest.mark.parametrize(
    "count, a, expected", [(128, 1 / 128, 0.6335623), (1000, 0.001, 0.6323046)]
)
def test_many_equal_layers(executor, count, a, expected):
    """Case 35: 1 - (1 - a)^n, to float rounding: 1000 additions of 2^-24 relative error."""
    image = stack(executor, [(1 + 0.01 * i, a, (1, 1, 1)) for i in range(count)])
    assert np.abs(image[..., 3] - expected).max() <= 1000 * 2.0**-24


def test_colours_front_to_back(executor):
    """Case 35: colour of layer i is a (1 - a)^i c_i, whatever the order in which layers are given."""
    image = stack(executor, [(3, 0.5, (0, 0, 1)), (1, 0.5, (1, 0, 0)), (2, 0.5, (0, 1, 0))])
    assert np.abs(image - [0.5, 0.25, 0.125, 0.875]).max() <= 1e-6


def test_coincident_layers_both_count(executor):
    """Case 40."""
    image = stack(executor, [(1, 0.3, (1, 1, 1)), (1, 0.6, (1, 1, 1))])
    assert np.abs(image[..., 3] - (1 - 0.7 * 0.4)).max() <= 1e-6


def test_opacity_threshold_is_exact(executor):
    """Case 38: planes of .1 under the threshold .2 stop after the third layer (.271)."""
    for bucket in (16, 64):
        layers = [(1 + i, 0.1, (1, 1, 1)) for i in range(20)]
        image = stack(executor, layers, opacity_threshold=0.2, bucket_size=bucket)
        assert np.abs(image[..., 3] - 0.271).max() <= 1e-6


def test_opaque_hides_what_is_behind(executor):
    """Case 44 and M6: geometry behind an opaque plane changes no bit."""
    front = [(1, 0.25, (1, 0, 0)), (2, None, (0, 1, 0))]
    behind = [(3, 0.5, (0, 0, 1)), (4, None, (1, 1, 1))]
    assert np.array_equal(stack(executor, front), stack(executor, front + behind))


def test_time_correlated_layers(executor):
    """Case 41: covers [.2, .6] with .5 and [.1, .6] with .7: T = .59, not the .52 of blur-then-composite."""
    # Coarse dicing keeps the brute force short; the bands are flat.
    snapshot = s.orthographic((16, 16), samples=1024, executor=executor, dicing_rate=32)
    length = 1000.0

    def covering(t0, t1, z, a):
        """A band moving right so that it covers the frame's centre pixel during [t0, t1]."""
        s.quad(
            snapshot,
            s.rectangle(8 - length * t1, -20, 8 - length * t0, 40, z),
            s.emission(snapshot, (1, 1, 1), a),
            transforms=[s.translation(0), s.translation(length)],
        )

    covering(0.2, 0.6, 1.0, 0.5)
    covering(0.1, 0.6, 2.0, 0.7)
    image = s.alpha(snapshot)
    # Each pixel's times are stratified: four crossings err by at most 1/N each, and a pixel's place shifts them by 8/1000.
    assert np.abs(image[:, 7:9].mean() - 0.41) <= 4 / 1024 + 1 / length


def test_lens_correlated_layers(executor):
    """Case 41 through the lens: two edges that hide the same half of it let 1 - (a + b - a b) / 2 through, where
    blur-then-composite has (1 - a / 2) (1 - b / 2)."""
    a, b, samples = 0.5, 0.7, 256
    snapshot = s.perspective((16, 16), 16.0, samples=samples, executor=executor, dicing_rate=32)
    snapshot["camera"] |= {"lens_radius": 0.5, "focus_distance": 4.0}
    for alpha in (
        a,
        b,
    ):  # the edge is the optical axis, two units before the focus: a circle of 4 pixels radius
        s.quad(snapshot, s.rectangle(-9, -9, 0, 9, 2.0), s.emission(snapshot, (1, 1, 1), alpha))
    image = s.alpha(snapshot)[:, 7:9]
    expected = (a + b - a * b) / 2
    assert abs(image.mean() - expected) <= 4 * expected / np.sqrt(image.size * samples)
    assert abs(expected - (1 - (1 - a / 2) * (1 - b / 2))) > 0.05  # it can tell the two apart


def test_diced_patch_has_no_seams(executor):
    """Case 42: the interior of a diced transparent patch is constant."""
    snapshot = s.perspective((64, 64), 60.0, samples=16, executor=executor, grid_size=64)
    points = [(-2, -2, 2), (2, -2, 4), (2, 2, 5), (-2, 2, 2.5)]
    s.quad(snapshot, points, s.emission(snapshot, (1, 1, 1), 0.37))
    image = s.alpha(snapshot)[24:40, 24:40]
    assert np.abs(image - 0.37).max() <= 1e-6


def test_moving_transparent_patch_has_no_seams(executor):
    """Case 42 in motion: shared edges are hit once at any time."""
    snapshot = s.orthographic((64, 64), samples=64, executor=executor, grid_size=16)
    transforms = [s.translation(-6.3, 2.1), s.translation(6.9, -3.7)]
    s.quad(
        snapshot,
        s.rectangle(-60, -60, 120, 120),
        s.emission(snapshot, (1, 1, 1), 0.37),
        transforms=transforms,
    )
    assert np.abs(s.alpha(snapshot) - 0.37).max() <= 1e-6


@pytest.mark.parametrize("a", [0.3, 0.05])
def test_layers_behind_saturated_samples_are_not_shaded(a):
    """The list ends after n = log(1 - threshold) / log(1 - a) layers; what is behind is neither shaded nor, a few
    z-batches on, diced."""
    threshold, count = 0.996, 400
    snapshot = s.orthographic(
        (64, 64), samples=4, executor="SIMD", opacity_threshold=threshold, threads=1
    )
    material = s.emission(snapshot, (1, 1, 1), a)
    for i in range(count):
        s.quad(snapshot, s.rectangle(0, 0, 64, 64, 1 + i), material)
    statistics = s.render(snapshot)["statistics"]
    layers = int(np.ceil(np.log(1 - threshold) / np.log(1 - a)))
    whole = statistics["points_diced"] / statistics["grids_diced"]  # all grids are alike
    assert statistics["points_shaded"] == statistics["grids_shaded"] * whole
    assert statistics["grids_shaded"] == layers * 16
    assert statistics["grids_diced"] < 3 * layers * 16 + 8 * 16


def busy(executor, seed, **options):
    """Twelve sheets through each other: clear, thin, coloured, opaque, partly additive; some move."""
    random = np.random.default_rng(seed)
    snapshot = s.perspective((48, 48), 48.0, samples=16, executor=executor, grid_size=64, **options)
    for i in range(12):
        a = [0.0, 0.02, 0.3, 0.7, 0.97, 1.0, None][random.integers(7)]
        material = s.emission(snapshot, random.uniform(0, 2, 3), a)
        if a == 0.3:  # spectral: what passes is coloured
            nodes = snapshot["materials"][material]["nodes"]
            nodes[1]["inputs"]["Color"] = (*random.uniform(0.1, 1, 3), 1)
        corner = random.uniform(-2, 0.5, 2)
        x0, y0, x1, y1 = *corner, *(corner + random.uniform(1, 4, 2))
        z = random.uniform(2, 6, 4)
        z[3] = z[0] + z[2] - z[1]
        points = [(x0, y0, z[0]), (x1, y0, z[1]), (x1, y1, z[2]), (x0, y1, z[3])]
        if min(z) < 0.5:
            continue
        shift = random.uniform(-0.3, 0.3, 3) if i % 3 == 0 else np.zeros(3)
        s.quad(snapshot, points, material, transforms=[s.translation(0), s.translation(*shift)])
    return s.render(snapshot)


@pytest.mark.parametrize("threshold", [0.2, 0.9, 1.0])
def test_batches_and_buckets_change_no_bit(executor, threshold):
    """M1 and M3: the threshold is each sample's, on its sorted list."""
    common = {"opacity_threshold": threshold, "depth_pass": True, "pass_alpha_threshold": 0.5}
    expected = busy(executor, 1, z_batch_size=26, **common)
    for z_batch_size, bucket_size in ((1, 16), (10, 64), (1000, 32), (65536, 16)):
        other = busy(executor, 1, z_batch_size=z_batch_size, bucket_size=bucket_size, **common)
        for plane in ("combined", "depth"):
            assert np.array_equal(expected[plane], other[plane]), plane


@hypothesis.settings(max_examples=25, deadline=None, derandomize=True)
@hypothesis.given(
    seed=st.integers(0, 2**32 - 1),
    threshold=st.sampled_from([0.3, 0.8, 0.996, 1.0]),
    z_batch_size=st.integers(1, 40),
    bucket_size=st.sampled_from([16, 48]),
    first_surface=st.sampled_from([0.0, 0.25, 0.75]),
)
def test_random_scenes_are_the_references(
    seed, threshold, z_batch_size, bucket_size, first_surface
):
    """Another z-batch and another bucket change no bit; the brute force, which keeps whole lists, sees the same."""
    common = {
        "opacity_threshold": threshold,
        "depth_pass": True,
        "pass_alpha_threshold": first_surface,
    }
    picture = busy("SIMD", seed, z_batch_size=z_batch_size, bucket_size=bucket_size, **common)
    other, reference = busy("SIMD", seed, **common), busy("REFERENCE", seed, **common)
    for plane in ("combined", "depth"):
        assert np.array_equal(picture[plane], other[plane]), plane
    difference = np.abs(picture["combined"] - reference["combined"]).max(axis=-1)
    # Float and double decide differently only where a sample is within 2^-12 pixel of an edge or layers are within
    # 4 ulp of each other; a sample's share is 1/16 of a colour of at most 2 a layer.
    assert np.mean(difference > 1e-5) <= 0.01 and difference.max() <= 0.5
    assert np.mean(~np.isclose(picture["depth"], reference["depth"], rtol=1e-5)) <= 0.01


@pytest.mark.parametrize(
    "device, sampling",
    [("COMPUTE", "INDEPENDENT"), ("RASTER", "INDEPENDENT"), ("RASTER", "REGULAR")],
)
@hypothesis.settings(max_examples=6, deadline=None, derandomize=True)
@hypothesis.given(
    seed=st.integers(0, 2**32 - 1),
    threshold=st.sampled_from([0.3, 0.8, 0.996, 1.0]),
    z_batch_size=st.integers(1, 40),
)
def test_random_scenes_through_opengl_are_the_references(
    device, sampling, seed, threshold, z_batch_size
):
    """Of coarse micropolygons, which the raster executor tests against every sample around their ways."""
    common = {"sampling": sampling, "time_samples": 3, "opacity_threshold": threshold}
    common |= {"dicing_rate": 8.0}
    picture = busy(device, seed, z_batch_size=z_batch_size, **common)
    difference = np.abs(picture["combined"] - busy("REFERENCE", seed, **common)["combined"])
    # As above; vertices of passes lie on a grid of 2^-8 texel, which is 2^-10 pixel: four times as many samples.
    share = 0.04 if sampling == "REGULAR" else 0.01
    assert np.mean(difference.max(axis=-1) > 1e-5) <= share
    assert difference.max() <= 0.5


def test_threshold_costs_at_most_its_share_of_the_brightest(executor):
    """bias <= (1 - threshold) times the brightest colour, be it of the world."""
    for threshold in (0.5, 0.9, 0.996):
        layers = [(1 + i, 0.15, (1, 0.2, 3)) for i in range(60)]
        for world, brightest in ((None, 3), (10.0, 10)):
            exact = stack(executor, layers, world=world, opacity_threshold=1.0)
            picture = stack(executor, layers, world=world, opacity_threshold=threshold)
            assert np.abs(picture - exact).max() <= (1 - threshold) * brightest + 1e-6


ALL_EXECUTORS = [
    ("REFERENCE", "INDEPENDENT"),
    ("SIMD", "INDEPENDENT"),
    ("COMPUTE", "INDEPENDENT"),
    ("RASTER", "INDEPENDENT"),
    ("RASTER", "REGULAR"),
]


@pytest.mark.parametrize("executor, sampling", ALL_EXECUTORS)
def test_the_world_never_shines_through_the_end_of_a_list(executor, sampling):
    """Two black sheets of .98 reach the threshold .996; what .0004 of is left is not that of a world of 1000."""
    sheets = [(1, 0.98, (0, 0, 0)), (2, 0.98, (0, 0, 0))]
    wall = [(3, None, (0, 0, 0))]
    common = {"world": 1000.0, "opacity_threshold": 0.996, "sampling": sampling}
    image = stack(executor, sheets + wall, **common)
    assert not image[..., :3].any()
    assert (image[..., 3] == 1).all()
    # Before the world itself too: as much may be missing as the threshold says, and no more.
    assert not stack(executor, sheets, **common)[..., :3].any()
    # A list that did not end shows what is behind it, world or wall.
    image = stack(executor, sheets[:1], **common)
    assert np.abs(image[..., :3] - 20).max() <= 20 * 2.0**-20
    assert not stack(executor, sheets[:1] + wall, **common)[..., :3].any()


def test_passes_see_no_world_behind_the_end_of_a_list(executor):
    """Combined is the sum of its passes, with a wall behind the sheets and without."""
    layers = [(1, 0.98, (1, 2, 3)), (2, 0.98, (3, 2, 1)), (3, None, (5, 5, 5))]
    passes = ["Emission", "Environment"]
    for count in (2, 3):
        common = {"world": 1000.0, "opacity_threshold": 0.996, "passes": passes}
        result = s.render(stack_of(executor, layers[:count], **common))
        assert not result["passes"]["Environment"].any()
        emission = result["passes"]["Emission"][..., :3]
        assert np.abs(result["combined"][..., :3] - emission).max() <= 1e-6


@pytest.mark.parametrize("world", [None, 1.0])
def test_a_material_cuts_what_it_does_not_let_through(executor, world):
    """A holdout of .25 over a wall and over nothing, beside a sheet that is none."""
    snapshot = s.orthographic((16, 16), samples=4, executor=executor)
    if world:
        s.constant_world(snapshot, world)
    s.quad(snapshot, s.rectangle(0, 0, 8, 8, 1), s.emission(snapshot, (9, 9, 9), alpha=0.25))
    snapshot["materials"][-1]["holdout"] = True
    s.quad(snapshot, s.rectangle(8, 8, 16, 16, 1), s.emission(snapshot, (0, 0, 0), alpha=0.25))
    s.quad(snapshot, s.rectangle(0, 0, 16, 4, 2), s.emission(snapshot, (2, 2, 2)))
    image = s.render(snapshot)["combined"]
    behind = world or 0.0
    covered = 1.0 if world else 0.0
    corners = {
        "both": (image[1:3, 1:7], 0.75 * 2, 0.75),
        "holdout": (image[5:7, 1:7], 0.75 * behind, 0.75 * covered),
        "wall": (image[1:3, 9:15], 2.0, 1.0),
        "sheet": (image[9:15, 9:15], 0.75 * behind, covered or 0.25),
    }
    if image[14, 1, 3] != covered:
        corners = {name: (part[::-1], *rest) for name, (part, *rest) in corners.items()}
    for name, (part, light, alpha) in corners.items():
        assert part[..., :3] == pytest.approx(light, abs=1e-5), name
        assert part[..., 3] == pytest.approx(alpha, abs=1e-5), name


def test_opaque_pictures_keep_no_lists():
    """A bucket without transparency stores no fragment and asks for no opacity."""
    snapshot = s.orthographic((64, 64), samples=16, executor="SIMD")
    s.quad(snapshot, s.rectangle(2, 3, 60, 50, 2), s.emission(snapshot))
    statistics = s.render(snapshot)["statistics"]
    for counter in ("fragments_stored", "grids_opacity_shaded", "buckets_transparent"):
        assert statistics[counter] == 0, counter


def test_lists_beyond_their_memory_are_made_in_parts(executor):
    """A tile whose lists want many times the memory is hidden in parts: same bits, with passes and crop too."""

    def picture(list_memory, **options):
        snapshot = s.orthographic(
            (32, 32), samples=64, executor=executor, threads=1, list_memory=list_memory, **options
        )
        for i in range(40):
            z = 1 + (7 * i) % 40
            a = None if i == 30 else 0.03 + 0.01 * (i % 3)
            edge = 40 if a else 9  # an opaque corner behind some
            s.quad(
                snapshot, s.rectangle(-8, -8, edge, edge, z), s.emission(snapshot, (1, z, 0.5), a)
            )
        return s.render(snapshot)

    for options in (
        {"crop": (3, 5, 20, 18)},
        {"crop": (0, 0, 16, 16), "passes": ["Emission", "Object Index"], "depth_pass": True},
    ):
        whole, parts = picture(1 << 12, **options), picture(1, **options)
        assert whole["statistics"]["peak_list_bytes"] > 4 << 20
        if executor != "COMPUTE":  # which notices after a batch on the device
            # What one grid brings may pass the limit, and vectors grow by doubling.
            assert parts["statistics"]["peak_list_bytes"] < 4 << 20
        assert np.array_equal(whole["combined"], parts["combined"])
        for name, values in whole.get("passes", {}).items():
            assert np.array_equal(values, parts["passes"][name]), name
        if "depth_pass" in options:
            assert np.array_equal(whole["depth"], parts["depth"])


def test_what_lies_behind_the_ends_of_lists_is_not_kept():
    """40 sheets front to back, 7 of which reach the threshold: z-batches keep the others from being stored."""
    for executor in ("SIMD", "COMPUTE"):
        snapshot = s.orthographic(
            (64, 64), samples=16, executor=executor, threads=1, opacity_threshold=0.9
        )
        for i in range(40):
            sheet = s.rectangle(-8, -8, 72, 72, 1 + i)
            s.quad(snapshot, sheet, s.emission(snapshot, (1, 1, 1), 0.3))
        result = s.render(snapshot)
        assert np.abs(result["combined"][..., 3] - (1 - 0.7**7)).max() < 1e-6
        # A batch may bring some more before it is noticed.
        stored = result["statistics"]["fragments_stored"] / (64 * 64 * 16)
        assert 7 <= stored <= 20, executor


# The slow ones: a quarter of the frame, and of the limit.
@pytest.mark.parametrize("executor, size", [("SIMD", 32), ("COMPUTE", 16), ("REFERENCE", 16)])
def test_sixteen_thousand_spheres_under_a_memory_limit(executor, size):
    """Case 43: 256 MiB of lists give the picture of unlimited ones."""
    limit = 256 * size**2 // 32**2

    def picture(list_memory):
        random = np.random.default_rng(43)
        snapshot = s.orthographic(
            (32, 32),
            samples=20,
            crop=(0, 0, size, size),
            executor=executor,
            threads=1,
            dicing_rate=4,
            list_memory=list_memory,
        )
        centers = random.uniform((0, 0, 10), (32, 32, 500), (16000, 3))
        snapshot["geometries"].append(
            {
                "name": "points 'Spheres'",
                "kind": "POINTS",
                "points": np.float32(centers)[None],
                "radius": np.full((1, len(centers)), 4, np.float32),
            }
        )
        s.instance(snapshot, 0, s.emission(snapshot, (1, 0.5, 0.2), 0.004))
        return s.render(snapshot)

    unlimited, limited = picture(1 << 15), picture(limit)
    assert unlimited["statistics"]["peak_list_bytes"] > 1.17 * limit * (1 << 20)
    assert limited["statistics"]["peak_list_bytes"] <= 1.25 * limit * (1 << 20)
    assert np.array_equal(unlimited["combined"], limited["combined"])
