# SPDX-License-Identifier: GPL-3.0-or-later
"""More lamps than are asked each: a point chooses of them, and what it sees is right on the mean."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import diffuse, inside, reflecting, room

SIZE = (48, 32)
ALBEDO = 0.8
DEPTH = 20.0  # of the floor


def floor(lights, **options):
    """A matte floor straight before an orthographic camera, a pixel a unit."""
    options = {"executor": "SIMD", "samples": 16, "light_samples": 16, **options}
    snapshot = s.orthographic(SIZE, **options)
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (ALBEDO,) * 3 + (1,)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    s.quad(snapshot, s.rectangle(-2, -2, SIZE[0] + 2, SIZE[1] + 2, DEPTH), 0)
    snapshot["lights"] = lights
    return snapshot


def lamp(place, energy, **settings):
    knots = np.stack([s.translation(*p) for p in np.atleast_2d(place)])
    light = {"name": "Lamp", "kind": "POINT", "world_from_light": knots, "energy": energy}
    return {**light, "casts_shadow": False, **settings}


def places(count, seed=1, nearest=6.0):
    """Before the floor, and around it."""
    random = np.random.default_rng(seed)
    return random.uniform((-20, -20, 0), (SIZE[0] + 20, SIZE[1] + 20, DEPTH - nearest), (count, 3))


def irradiance(place, energy, at):
    """Of a point lamp on the floor, at points [h,w,2]."""
    d = np.concatenate([at - place[:2], np.full((*at.shape[:2], 1), DEPTH - place[2])], -1)
    r2 = (d**2).sum(-1)
    return energy / (4 * np.pi) / r2 * d[..., 2] / np.sqrt(r2)


def expected(lamps):
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    at = np.stack([x, y], -1)
    return ALBEDO / np.pi * sum(irradiance(p, e, at) for p, e in lamps)


def red(snapshot):
    return s.render(snapshot)["combined"][::-1, :, 0]


# Lamps that are asked of many, in the floors below.  A point's relative error is its root's reciprocal at most, what a
# pixel shows is the mean of a few, and importance comes near to what is given.
ASKED = 64


def checked(image, truth, error):
    """Of relative errors: RMSE, and a mean that is 0 within five of what so many independent ones may be off by (they are
    better: neighbours' choices are spread evenly)."""
    relative = image / truth - 1
    assert np.sqrt((relative**2).mean()) < error
    assert abs(relative.mean()) < 5 * error / np.sqrt(relative.size)


def oriented(image, truth):
    """The picture's rows as the lamps' places have them."""
    flipped = image[::-1]
    return image if ((image - truth) ** 2).sum() < ((flipped - truth) ** 2).sum() else flipped


def test_few_lamps_are_all_asked():
    lamps = [(p, 400.0) for p in places(16)]
    result = s.render(floor([lamp(*one) for one in lamps]))
    assert result["statistics"]["lamps_chosen"] == 0
    image, truth = result["combined"][..., 0], expected(lamps)
    # Within a pixel and a micropolygon light bends.
    np.testing.assert_allclose(oriented(image, truth), truth, rtol=0.02)


@pytest.mark.parametrize("count", [17, 100, 1000])
def test_sum_of_inverse_squares(count):
    random = np.random.default_rng(2)
    energies = random.uniform(0.1, 2.0, count) * 4000 / count
    lamps = list(zip(places(count), energies, strict=True))
    truth = expected(lamps)
    image = oriented(red(floor([lamp(*one) for one in lamps])), truth)
    checked(image, truth, ASKED**-0.5 / 4)


def test_more_light_samples_ask_more_lamps_and_err_less():
    lamps = [(p, 4.0) for p in places(1000)]
    truth = expected(lamps)
    errors, chosen = [], []
    for samples in (1, 4, 16):
        result = s.render(floor([lamp(*one) for one in lamps], light_samples=samples))
        image = oriented(result["combined"][..., 0], truth)
        errors.append(np.sqrt(((image / truth - 1) ** 2).mean()))
        statistics = result["statistics"]
        chosen.append(statistics["lamps_chosen"] / statistics["points_shaded"])
    assert errors[1] < 0.6 * errors[0] and errors[2] < 0.6 * errors[1]
    assert chosen[0] <= 4 and chosen[1] <= 16 and chosen[2] <= ASKED


def test_ten_times_the_lamps_are_not_asked_more_often():
    chosen = []
    for count in (1000, 10000):
        snapshot = floor([lamp(p, 4000 / count) for p in places(count)])
        statistics = s.render(snapshot)["statistics"]
        chosen.append(statistics["lamps_chosen"] / statistics["points_shaded"])
    assert chosen[1] < 1.2 * chosen[0]


def test_one_lamp_in_200_parts():
    place = (SIZE[0] / 2, SIZE[1] / 2, 5.0)
    one = red(floor([lamp(place, 4000.0)]))
    many = red(floor([lamp(place, 20.0)] * 200))
    np.testing.assert_allclose(many, one, rtol=1e-4)


def test_a_soft_lamp_in_200_parts():
    place = (SIZE[0] / 2, SIZE[1] / 2, 5.0)
    one = red(floor([lamp(place, 4000.0, radius=2.0)]))
    many = red(floor([lamp(place, 20.0, radius=2.0)] * 200))
    checked(many, one, 0.02)


def test_suns_are_always_asked():
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    sun = {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": 3.0}
    dim = [lamp(p, 1e-3) for p in places(100)]
    image = red(floor([*dim[:50], {**sun, "casts_shadow": False}, *dim[50:]]))
    np.testing.assert_allclose(image, ALBEDO * 3.0 / np.pi, rtol=1e-3)


def test_lamps_that_light_others_are_not_chosen():
    lamps = [(p, 4.0) for p in places(300)]
    lights = [lamp(*one, receiver_set=i % 3) for i, one in enumerate(lamps)]
    snapshot = floor(lights)
    snapshot["instances"]["receives"] = [0b010]
    truth = expected(lamps[1::3])
    checked(oriented(red(snapshot), truth), truth, 0.02)


def test_lamps_that_move():
    """Each point's light is the mean over the way, at 64 times of it."""
    starts = places(200, seed=3, nearest=6.0)
    ends = starts + np.random.default_rng(4).uniform(-6, 6, starts.shape) * (1, 1, 0.5)
    lights = [lamp((a, b), 20.0) for a, b in zip(starts, ends, strict=True)]
    times = (np.arange(64) + 0.5) / 64
    truth = sum(
        expected([(a + (b - a) * t, 20.0) for a, b in zip(starts, ends, strict=True)])
        for t in times
    )
    truth /= len(times)
    image = oriented(red(floor(lights)), truth)
    checked(image, truth, 0.03)


def test_lamps_that_blink():
    """Half of them are there for a quarter of the shutter."""
    lamps = [(p, 20.0) for p in places(200)]
    lights = [lamp(*one, lifespan=(0.5, 0.75)) for one in lamps[::2]]
    lights += [lamp(*one) for one in lamps[1::2]]
    truth = expected([(p, 5.0) for p, _ in lamps[::2]] + lamps[1::2])
    checked(oriented(red(floor(lights)), truth), truth, 0.04)


def glossy_scene(count=150, kind="POINT", **options):
    """Soft lamps over a glossy floor with things on it that move: choices, shadows, lobes that meet lamps."""
    shape = {"radius": 1.5} if kind == "POINT" else {"size": (3.0, 2.0), "shape": "RECTANGLE"}
    lights = [lamp(p, 1200.0 / count, kind=kind, casts_shadow=True, **shape) for p in places(count)]
    for light in lights:
        light["world_from_light"] = light["world_from_light"] @ np.diag([1.0, -1.0, -1.0, 1.0])
    snapshot = floor(lights, **options)
    inputs = {"Color": (0.8, 0.8, 0.8, 1), "Roughness": 0.3}
    nodes = [{"type": "ShaderNodeBsdfGlossy", "inputs": inputs}]
    snapshot["materials"][0].update(nodes=nodes)
    for x, y in ((10, 8), (30, 20), (38, 6)):
        moves = [s.translation(-1), s.translation(1)]
        s.quad(snapshot, s.rectangle(x, y, x + 5, y + 4, DEPTH - 2), 0, transforms=moves)
    return snapshot


@pytest.mark.parametrize("kind", ["POINT", "AREA"])
def test_many_are_the_sum_of_few(kind):
    """Of which each is asked: choices, shadows and what lobes meet weigh each other rightly."""
    many = glossy_scene(160, kind)
    chosen = s.render(many)
    assert chosen["statistics"]["lamps_chosen"] > 0
    lights = many["lights"]
    truth = 0.0
    for k in range(0, 160, 16):
        few = s.render({**many, "lights": lights[k : k + 16]})
        assert few["statistics"]["lamps_chosen"] == 0
        truth = truth + few["combined"][..., 0]
    image = chosen["combined"][..., 0]
    assert np.sqrt(((image - truth) ** 2).mean()) < 0.06 * truth.mean()
    assert abs(image.mean() - truth.mean()) < 0.003 * truth.mean()


@pytest.mark.parametrize(
    "options", [{"threads": 3}, {"bucket_size": 16}, {"executor": "REFERENCE"}]
)
def test_the_bits_do_not_depend_on(options):
    snapshot = glossy_scene(light_samples=8)
    image = s.render(snapshot)["combined"]
    snapshot["options"].update(options)
    np.testing.assert_array_equal(s.render(snapshot)["combined"], image)


def test_lamps_that_share_nodes_are_asked_by_what_each_sends():
    """All have the same nodes, which let one of three shine a thousand times as bright as the rest."""
    bright = np.arange(300) % 3 == 2
    spots = [
        (x, y, 4.0 if lit else 8.0) for (x, y, _), lit in zip(places(300, 4), bright, strict=True)
    ]
    nodes = [
        {"type": "ShaderNodeNewGeometry", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Position")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 1, "Z"), "Value_001": 6.0},
            "properties": {"operation": "LESS_THAN"},
        },
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 2, "Value"), "Value_001": 1e-3},
            "properties": {"operation": "ADD"},
        },
        {"type": "ShaderNodeEmission", "inputs": {"Strength": ("LINK", 3, "Value")}},
    ]
    more = {"nodes": nodes, "surface": (4, "Emission")}
    image = s.render(floor([lamp(p, 400.0, **more) for p in spots]))["combined"][..., 0]
    lamps = [(p, 400.0 * (lit + 1e-3)) for p, lit in zip(spots, bright, strict=True)]
    truth = expected(lamps)
    image = oriented(image, truth)
    # .085 was seen where all were taken for as bright as the first.
    checked(image, truth, 0.02)


@pytest.mark.parametrize("surface", ["Diffuse", "Glossy"])
def test_what_rays_meet_chooses_among_few(surface):
    """Ten lamps in a room are what each gives by itself (.2 and .1 % more).  The eye's
    points ask them all."""

    def lit(lamps, bounces=3):
        snapshot = inside(bounces, light_samples=16)
        room(snapshot, reflecting(snapshot, surface, 0.6, Roughness=0.4))
        room(snapshot, diffuse(snapshot, 0.5), half=0.15, transforms=s.translation(0, 0, 0.4)[None])
        # Bounces as Blender's lamps have them.
        options = {"radius": 0.1, "casts_shadow": True, "most_bounces": 1024}
        snapshot["lights"] = [lamp(place, 5.0, **options) for place in lamps]
        result = s.render(snapshot)
        return result["combined"][..., 0].mean(), result["statistics"]

    around = np.random.default_rng(3).uniform(-0.8, 0.8, (10, 3))
    mean, counted = lit(around)
    assert mean == pytest.approx(sum(lit([one])[0] for one in around), rel=0.01)
    assert 0 < counted["lamps_chosen"] < 6 * counted["hits_shaded"]
    assert lit(around[:8])[1]["lamps_chosen"] == 0
    assert lit(around, bounces=0)[1]["lamps_chosen"] == 0


@pytest.mark.parametrize(
    "options", [{"bucket_size": 16}, {"threads": 1}, {"crop": np.int32([4, 8, 20, 24])}]
)
def test_bits_of_what_rays_meet_do_not_depend_on_buckets_threads_or_crop(options):
    def seen(**more):
        snapshot = inside(2, light_samples=4, **more)
        room(snapshot, reflecting(snapshot, "Glossy", 0.6, Roughness=0.4))
        around = np.random.default_rng(3).uniform(-0.8, 0.8, (12, 3))
        snapshot["lights"] = [lamp(place, 5.0, radius=0.1) for place in around]
        snapshot["lights"][3]["most_bounces"] = 0
        return s.render(snapshot)["combined"]

    whole = seen()
    if "crop" in options:
        whole = whole[8:24, 4:20]
    assert np.array_equal(whole, seen(**options))
