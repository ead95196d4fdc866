# SPDX-License-Identifier: GPL-3.0-or-later
"""What fills things against closed forms: Beer and Lambert's law, emission, light that is scattered once."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse, inside, material
from test_shining_meshes import ball

SIGMA = 0.3


def absorption(density=SIGMA, color=0.0):
    return {
        "type": "ShaderNodeVolumeAbsorption",
        "inputs": {"Color": (color, color, color, 1.0), "Density": density},
    }


def scatter(density, color=1.0, anisotropy=0.0):
    return {
        "type": "ShaderNodeVolumeScatter",
        "inputs": {
            "Color": (color, color, color, 1.0),
            "Density": density,
            "Anisotropy": anisotropy,
        },
    }


def both(extinction, albedo):
    """Of what is taken from a ray, `albedo` goes on elsewhere."""
    return scatter(extinction, albedo), absorption(extinction, albedo)


def emitted(strength):
    return {"type": "ShaderNodeEmission", "inputs": {"Color": (1.0,) * 4, "Strength": strength}}


def filled(snapshot, *nodes, surface=None):
    """A material with the sum of volume nodes in it, and no surface but where `surface` nodes say so."""
    nodes = list(nodes)
    outputs = {"ShaderNodeEmission": "Emission"}
    last = (0, outputs.get(nodes[0]["type"], "Volume"))
    for i in range(1, len(nodes)):
        inputs = {
            "Shader": ("LINK", *last),
            "Shader_001": ("LINK", i, outputs.get(nodes[i]["type"], "Volume")),
        }
        nodes.append({"type": "ShaderNodeAddShader", "inputs": inputs})
        last = (len(nodes) - 1, "Shader")
    root = None
    if surface is not None:
        root = (len(nodes), "BSDF")
        nodes.append(surface)
    index = material(snapshot, nodes, root)
    snapshot["materials"][index]["volume"] = last
    return index


def box(snapshot, low, high, surface, **more):
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    points = np.array(low) + np.array(corners, float) * (np.array(high, float) - low)
    # Outwards: counter-clockwise as seen from outside.
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return s.mesh(snapshot, points, faces, surface, **more)


def wall(snapshot, z=10.0, color=(1, 1, 1)):
    s.quad(snapshot, s.rectangle(-90, -90, 90, 90, z), s.emission(snapshot, color))


def view(size=(16, 16), **options):
    return s.orthographic(size, samples=4, **options)


def mean(snapshot):
    return s.render(snapshot)["combined"][..., 0].mean()


def test_a_slab_dims_what_is_behind_it(executor):
    snapshot = view(executor=executor)
    wall(snapshot)
    box(snapshot, (-1, -1, 2), (20, 20, 5), filled(snapshot, absorption()))
    image = s.render(snapshot)["combined"]
    assert image[..., :3] == pytest.approx(np.exp(-3 * SIGMA), rel=1e-5)
    assert image[..., 3] == pytest.approx(1.0)


def test_alpha_is_what_does_not_pass():
    snapshot = view()
    box(snapshot, (-1, -1, 2), (20, 20, 5), filled(snapshot, absorption()))
    image = s.render(snapshot)["combined"]
    assert image[..., :3] == pytest.approx(0.0)
    assert image[..., 3] == pytest.approx(1 - np.exp(-3 * SIGMA), rel=1e-5)


def test_each_channel_has_a_coefficient():
    snapshot = view()
    wall(snapshot)
    node = absorption()
    node["inputs"]["Color"] = (1.0, 0.5, 0.0, 1.0)
    box(snapshot, (-1, -1, 2), (20, 20, 5), filled(snapshot, node))
    image = s.render(snapshot)["combined"][8, 8, :3]
    assert image == pytest.approx(np.exp(-3 * SIGMA * np.array([0.0, 0.5, 1.0])), rel=1e-5)


@pytest.mark.parametrize("sigma", [0.0, 1e-6, 0.3, 20.0])
def test_what_emits_is_seen_through_itself(sigma):
    snapshot = view()
    box(snapshot, (-1, -1, 2), (20, 20, 5), filled(snapshot, emitted(0.7), absorption(sigma)))
    expected = 0.7 * (3.0 if sigma == 0 else -np.expm1(-3 * sigma) / sigma)
    assert mean(snapshot) == pytest.approx(expected, rel=1e-5)


def test_media_that_overlap_add_up():
    """The boxes share 4 to 5, and a face at 7."""
    snapshot = view()
    wall(snapshot)
    for low, high in ((2, 5), (4, 7), (7, 8)):
        box(snapshot, (-1, -1, low), (20, 20, high), filled(snapshot, absorption()))
    assert mean(snapshot) == pytest.approx(np.exp(-7 * SIGMA), rel=1e-5)


def test_the_camera_may_be_inside():
    snapshot = view()
    wall(snapshot)
    box(snapshot, (-1, -1, -4), (20, 20, 5), filled(snapshot, absorption()))
    assert mean(snapshot) == pytest.approx(np.exp(-(5 - 0.01) * SIGMA), rel=1e-5)


def test_surfaces_stand_inside():
    """The part of a layer is dimmed by what is before it: half is there, half behind all."""
    snapshot = view()
    wall(snapshot)
    box(snapshot, (-1, -1, 2), (20, 20, 5), filled(snapshot, emitted(0.2), absorption()))
    s.quad(snapshot, s.rectangle(-50, -50, 50, 50, 3.0), s.emission(snapshot, (2, 2, 2), alpha=0.5))
    sent = [0.2 * -np.expm1(-SIGMA * d) / SIGMA for d in (1.0, 2.0)]
    t = [np.exp(-SIGMA), np.exp(-3 * SIGMA)]
    expected = sent[0] + t[0] * 0.5 * 2 + 0.5 * (t[0] * sent[1] + t[1])
    assert mean(snapshot) == pytest.approx(expected, rel=1e-5)


def test_a_moving_slab_is_there_as_long_as_it_is():
    """It enters the view within the shutter: at the left edge it is there all the time, at the right never."""
    snapshot = s.orthographic((64, 4), samples=256)
    wall(snapshot)
    box(
        snapshot,
        (-200, -50, 2),
        (0, 50, 5),
        filled(snapshot, absorption()),
        transforms=[s.translation(0.0), s.translation(64.0)],
    )
    image = s.render(snapshot)["combined"][..., 0].mean(axis=0)
    there = 1.0 - (np.arange(64) + 0.5) / 64
    expected = 1 - there * (1 - np.exp(-3 * SIGMA))
    # 1024 stratified samples a column, of a step.
    assert np.abs(image - expected).max() < 0.02
    assert image.mean() == pytest.approx(expected.mean(), rel=2e-3)


def test_a_slab_dims_through_the_lens():
    snapshot = s.perspective((32, 32), 64.0, samples=64)
    snapshot["camera"].update(lens_radius=0.02, focus_distance=5.0)
    wall(snapshot)
    box(snapshot, (-2, -2, 4), (2, 2, 6), filled(snapshot, absorption()))
    # In the middle rays run along the axis, but for the lens, which lengthens them by .4 %.
    middle = s.render(snapshot)["combined"][15:17, 15:17, 0].mean()
    assert middle == pytest.approx(np.exp(-2 * SIGMA), rel=2e-3)


def world_of(snapshot, *nodes, background=1.0):
    s.constant_world(snapshot, background)
    snapshot["world"]["lights_scene"] = True
    snapshot["world"]["nodes"] += list(nodes)
    snapshot["world"]["volume"] = (1, "Volume" if "Volume" in nodes[0]["type"] else "Emission")


@pytest.mark.parametrize("near", [0.01, 1.5])
def test_a_world_that_is_filled_hides_its_background(near):
    """From the near plane on, as in Cycles."""
    snapshot = view()
    snapshot["camera"]["clip"] = (near, 1e4)
    world_of(snapshot, absorption())
    s.quad(snapshot, s.rectangle(0, 0, 8, 16, 4.0), s.emission(snapshot))
    image = s.render(snapshot)["combined"][..., 0]
    assert image[:, :7] == pytest.approx(np.exp(-(4 - near) * SIGMA), rel=1e-5)
    assert image[:, 9:] == pytest.approx(0.0)


def test_rays_through_the_lens_begin_at_the_near_plane():
    """In perspective, at the picture's corner too, whatever point of the lens they leave."""
    snapshot = s.perspective((32, 32), 32.0, samples=64, clip=(1.0, 1e4))
    snapshot["camera"].update(lens_radius=0.05, focus_distance=3.0)
    world_of(snapshot, absorption())
    wall(snapshot, 3.0)
    image = s.render(snapshot)["combined"][..., 0]
    x = (np.arange(32) + 0.5 - 16) / 32
    stretch = np.sqrt(1 + x[:, None] ** 2 + x**2)
    # The lens turns rays by up to .05 / 3, of which the mean is 0: what is left is of second order.
    assert np.abs(image / np.exp(-2 * SIGMA * stretch) - 1).max() < 2e-3


LAMP = {
    "name": "Lamp",
    "kind": "POINT",
    "color": (1, 1, 1),
    "energy": 400.0,
    "radius": 0.0,
}


@pytest.mark.parametrize(
    ("reach", "depth"), [(5.0, 0.5), (200.0, 0.5), (1e4, 0.5), (1e5, 0.5), (200.0, 100.0)]
)
def test_a_world_that_varies_is_passed_to_its_end(reach, depth):
    """Density falls along the view to nothing at `reach` metres; 1,024 steps of a metre saw no further than that."""
    snapshot = s.orthographic((16, 16), samples=64)
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 1, "Object")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {
                "Value": ("LINK", 2, "Z"),
                "Value_001": -2 * depth / reach**2,
                "Value_002": 2 * depth / reach,
            },
            "properties": {"operation": "MULTIPLY_ADD"},
        },
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 3, "Value"), "Value_001": 0.0},
            "properties": {"operation": "MAXIMUM"},
        },
    ]
    world_of(snapshot, absorption(("LINK", 4, "Value")))
    snapshot["world"]["nodes"][1:1] = nodes
    snapshot["world"]["volume"] = (5, "Volume")
    assert mean(snapshot) == pytest.approx(np.exp(-depth), rel=0.01, abs=1e-6)


def test_what_shines_does_not_shine_from_beyond_where_nothing_comes_through():
    """All that shines along a way that absorbs ever less: 14 optical depths lie before 74 metres, and light from behind them
    counts as little as the darkness there lets pass."""
    snapshot = s.orthographic((16, 16), samples=64)
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 1, "Object")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 2, "Z"), "Value_001": -0.2},
            "properties": {"operation": "MULTIPLY"},
        },
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 3, "Value")},
            "properties": {"operation": "EXPONENT"},
        },
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 4, "Value"), "Value_001": 3.0},
            "properties": {"operation": "MULTIPLY"},
        },
    ]
    world_of(snapshot, absorption(("LINK", 5, "Value")), background=0.0)
    snapshot["world"]["nodes"][1:1] = nodes
    shine = {"type": "ShaderNodeEmission", "inputs": {"Color": (1.0,) * 4, "Strength": 1.0}}
    add = {"Shader": ("LINK", 6, "Volume"), "Shader_001": ("LINK", 7, "Emission")}
    snapshot["world"]["nodes"] += [shine, {"type": "ShaderNodeAddShader", "inputs": add}]
    snapshot["world"]["volume"] = (8, "Shader")
    z = np.linspace(0.0, 60.0, 600001)
    passed = np.exp(-15.0 * (1.0 - np.exp(-0.2 * z)))
    # Steps of a metre, within which the medium thins by a fifth, are 4.5 % too bright.
    assert mean(snapshot) == pytest.approx(np.trapz(passed, z), rel=0.06)


def lamp(snapshot, place, **more):
    matrix = np.eye(4)
    matrix[:3, 3] = place
    snapshot.setdefault("lights", []).append({**LAMP, "world_from_light": matrix[None], **more})


def scattered_once(d, sigma, intensity, z0=0.0, z1=np.inf):
    """Light of a point lamp d beside a ray and 20 along it, scattered once, evenly, to the ray's start."""
    z = np.linspace(z0, min(z1, 400.0), 2_000_001)
    r = np.sqrt(d * d + (z - 20.0) ** 2)
    f = intensity * sigma / (4 * np.pi) * np.exp(-sigma * (z + r)) / (r * r)
    return np.trapezoid(f, z) if hasattr(np, "trapezoid") else np.trapz(f, z)


def test_a_point_lamp_in_an_endless_medium():
    snapshot = s.orthographic((16, 16), samples=1024, film_transparent=False)
    world_of(snapshot, scatter(0.05), background=0.0)
    lamp(snapshot, (-5.0, 8.0, 20.0))
    image = s.render(snapshot)["combined"][..., 0].mean(axis=0)
    # Rows lie up to 8 away from the lamp's: the mean over them.
    expected = [
        np.mean(
            [scattered_once(np.hypot(x + 5.5, y - 7.5), 0.05, 400 / (4 * np.pi)) for y in range(16)]
        )
        for x in (0, 8, 15)
    ]
    assert image[[0, 8, 15]] == pytest.approx(np.array(expected), rel=0.01)


def test_light_of_lamps_is_dimmed_by_what_it_passes():
    """A diffuse floor below an absorbing slab, the lamp above it: the same as without, times what passes."""
    images = []
    for density in (0.0, 0.5):
        snapshot = view((8, 8))
        inputs = {"Color": (0.8, 0.8, 0.8, 1.0)}
        floor = material(
            snapshot, [{"type": "ShaderNodeBsdfDiffuse", "inputs": inputs}], (0, "BSDF")
        )
        s.quad(snapshot, s.rectangle(-50, -50, 50, 50, 10.0), floor)
        box(snapshot, (-90, -90, -3), (90, 90, -1), filled(snapshot, absorption(density)))
        lamp(snapshot, (4.0, 4.0, -1000.0), energy=1e8)
        images.append(s.render(snapshot)["combined"][..., 0])
    assert images[1] / images[0] == pytest.approx(np.exp(-2 * 0.5), rel=1e-4)


def lit_fog(**options):
    """Before and behind moving things: a box that scatters, and a floor that light comes to by way of both."""
    snapshot = s.busy("SIMD", samples=4, bounces=2, **options)
    box(snapshot, (-2, -2, 3), (2, 2, 6), filled(snapshot, scatter(0.2), emitted(0.1)))
    inputs = {"Color": (0.8, 0.8, 0.8, 1.0)}
    floor = material(snapshot, [{"type": "ShaderNodeBsdfDiffuse", "inputs": inputs}], (0, "BSDF"))
    s.quad(snapshot, [(-4, -1, 2), (4, -1, 2), (4, -1, 9), (-4, -1, 9)], floor)
    lamp(snapshot, (0.0, 3.0, 4.0))
    return s.render(snapshot)["combined"]


@pytest.mark.parametrize("options", [{"bucket_size": 16}, {"threads": 1}])
def test_no_bit_depends_on_buckets_or_threads(options):
    assert np.array_equal(lit_fog(), lit_fog(**options))


def test_crop_changes_no_bit():
    part = lit_fog(crop=np.array((20, 10, 60, 50), np.int32))
    assert np.array_equal(part, lit_fog()[10:50, 20:60])


def test_steps_of_what_varies_are_an_integral():
    """Density grows along the view as Generated's z does, from 0 to 2 over 3 metres."""
    snapshot = s.orthographic((16, 16), samples=64)
    wall(snapshot)
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Generated")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 1, "Z"), "Value_001": 2.0},
            "properties": {"operation": "MULTIPLY"},
        },
        absorption(("LINK", 2, "Value")),
    ]
    dense = material(snapshot, nodes, None)
    snapshot["materials"][dense]["volume"] = (3, "Volume")
    box(snapshot, (-1, -1, 2), (20, 20, 5), dense)
    # A step that is shifted at random is off by a part of itself: the mean over samples is not.
    assert mean(snapshot) == pytest.approx(np.exp(-3.0), rel=0.02)


@pytest.mark.parametrize("anisotropy", [0.0, 0.7])
@pytest.mark.parametrize("depth", [0.5, 2.0, 6.0])
def test_a_white_furnace(depth, anisotropy):
    """What only scatters cannot be told from a uniform world, however deep, once all light has left it: of light that
    enters a box `depth` mean ways wide less than a thousandth is left after 64 places."""
    snapshot = s.orthographic(
        (16, 16), samples=256, film_transparent=False, bounces=64, volume_bounces=64
    )
    s.constant_world(snapshot, 0.7)
    snapshot["world"]["lights_scene"] = True
    box(snapshot, (3, 3, 2), (13, 13, 12), filled(snapshot, scatter(depth / 10, 1.0, anisotropy)))
    image = s.render(snapshot)["combined"][..., 0]
    assert image[:2] == pytest.approx(0.7, rel=1e-5)
    # Means of 25,600 ways, of which one is off by less than .5.
    assert image[3:13, 3:13].mean() == pytest.approx(0.7, rel=0.015)


def test_each_place_that_light_is_scattered_at_counts():
    """A thin slab: of light that is scattered n + 1 times at most, the powers of the albedo up to there."""
    albedo, means = 0.6, []
    for limit in (0, 1, 2, 16):
        snapshot = s.orthographic(
            (16, 16), samples=256, film_transparent=False, bounces=20, volume_bounces=limit
        )
        s.constant_world(snapshot, 1.0)
        snapshot["world"]["lights_scene"] = True
        box(snapshot, (3, 3, 2), (13, 13, 12), filled(snapshot, *both(0.3, albedo)))
        means.append(s.render(snapshot)["combined"][3:13, 3:13, 0].mean())
    steps = np.diff(means)
    assert (steps > 0).all()
    # Each order is less than the one before by the albedo, and by what gets out.
    assert steps[1] < albedo * steps[0]


def reflected_by_half_space(albedo, sines=200, orders=400):
    """Of a half space that scatters evenly, seen straight on in a uniform world: 1 - H(1) sqrt(1 - albedo) with
    Chandrasekhar's H (1960), which this iterates."""
    x, w = np.polynomial.legendre.leggauss(sines)
    mu, w = 0.5 * (x + 1), 0.5 * w
    root = np.sqrt(1 - albedo)
    h = np.ones_like(mu)
    for _ in range(orders):
        h = 1 / (root + 0.5 * albedo * (w * mu * h / (mu[:, None] + mu)).sum(axis=1))
    at_one = 1 / (root + 0.5 * albedo * (w * mu * h / (1 + mu)).sum())
    return 1 - at_one * root


@pytest.mark.parametrize("albedo", [0.5, 0.9])
def test_a_half_space_reflects_as_chandrasekhars(albedo):
    snapshot = s.orthographic(
        (8, 8), samples=1024, film_transparent=False, bounces=200, volume_bounces=200
    )
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    # 400 mean ways wide, 40 deep: nothing is seen of its sides.
    box(snapshot, (-200, -200, 2), (208, 208, 42), filled(snapshot, *both(1.0, albedo)))
    image = s.render(snapshot)["combined"][..., 0]
    assert image.mean() == pytest.approx(reflected_by_half_space(albedo), rel=0.015)


@pytest.mark.parametrize("albedo", [0.1, 0.5, 0.8])
def test_what_fills_a_closed_ball_lights_its_wall(albedo):
    """4 pi of light for each of 4/3 pi r^3 come to 4 pi r^2 of wall, which takes 1 - albedo of what reaches it: there is no
    world, and what Russian roulette ends takes its part of the emission with it."""
    snapshot = inside(64)
    points, faces = ball(1.0, (0, 0, 0), around=96)
    outwards = [face[::-1] for face in faces]
    s.mesh(snapshot, points, outwards, diffuse(snapshot, albedo))
    s.mesh(snapshot, 0.999 * points, outwards, filled(snapshot, emitted(1.0)))
    x, y = np.meshgrid(*[(np.arange(32) + 0.5) / 16 - 1] * 2)
    near = 0.1 * np.sqrt(1 + x**2 + y**2).mean()  # the camera sees nothing nearer than that
    due = 1.0 - near + albedo / (1 - albedo) * 4 / 3
    # Flat faces leave .2 % of the ball out; noise is less.
    assert mean(snapshot) == pytest.approx(due, rel=0.005)


def test_a_floor_near_what_shines_inside():
    """A cube that shines, over a floor: each small part of it sends its power evenly around.  Nothing else is near, and
    what neighbours share of its light varies as fast as it is near."""
    strength, albedo, low, high, floor = 0.05, 0.8, (20, 20, 88), (30, 30, 98), 100.0
    snapshot = s.orthographic((48, 48), samples=16, bounces=1, light_samples=256)
    box(snapshot, low, high, filled(snapshot, emitted(strength)))
    s.quad(snapshot, s.rectangle(-64, -64, 128, 128, z=floor), diffuse(snapshot, albedo))
    columns, rows = np.arange(31, 42), np.arange(22, 28)
    seen = s.render(snapshot)["combined"][rows[0] : rows[-1] + 1, columns, 0].mean(axis=0)
    parts = [np.arange(a + 0.1, b, 0.2) for a, b in zip(low, high, strict=True)]
    x, y, z = np.meshgrid(*parts, indexing="ij")
    above = floor - z
    expected = [
        np.mean(
            [np.sum(above / ((x - c) ** 2 + (y - r) ** 2 + above**2) ** 1.5) for r in rows + 0.5]
        )
        for c in columns + 0.5
    ]
    assert seen == pytest.approx(strength * albedo / np.pi * 0.2**3 * np.array(expected), rel=0.04)
