# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from surface to surface against closed forms: furnaces, mirrors, ways through what lets light pass."""

import numpy as np
import pytest
import snapshots as s
from test_elements import cloud, curves

ALBEDO, EMITTED = 0.5, 1.0


def material(snapshot, nodes, surface):
    index = len(snapshot["materials"])
    snapshot["materials"].append({"name": f"Material {index}", "nodes": nodes, "surface": surface})
    return index


def reflecting(snapshot, lobe, albedo, emitted=0.0, **inputs):
    inputs = {"Color": (albedo,) * 3 + (1.0,), **inputs}
    nodes = [
        {"type": f"ShaderNodeBsdf{lobe}", "inputs": inputs},
        {"type": "ShaderNodeEmission", "inputs": {"Color": (1.0,) * 4, "Strength": emitted}},
        {
            "type": "ShaderNodeAddShader",
            "inputs": {"Shader": ("LINK", 0, "BSDF"), "Shader_001": ("LINK", 1, "Emission")},
        },
    ]
    return material(snapshot, nodes, (2, "Shader") if emitted else (0, "BSDF"))


def diffuse(snapshot, albedo, emitted=0.0):
    return reflecting(snapshot, "Diffuse", albedo, emitted)


def mirror(snapshot, color=1.0):
    inputs = {"Color": (color,) * 3 + (1.0,), "Roughness": 0.0}
    nodes = [{"type": "ShaderNodeBsdfGlossy", "inputs": inputs}]
    return material(snapshot, nodes, (0, "BSDF"))


def room(snapshot, surface, half=1.0, **more):
    """A closed cube around the camera."""
    corners = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    s.mesh(snapshot, half * np.array(corners, float), faces, surface, **more)


def inside(bounces, **options):
    """A view of 90 degrees from the middle of what is put around it."""
    limits = {
        "diffuse_bounces": 1000,
        "glossy_bounces": 1000,
        "clamp_indirect": 0.0,
        "filter_glossy": 0.0,
    }
    return s.perspective((32, 32), 16, samples=16, bounces=bounces, **{**limits, **options})


def mean(snapshot):
    return s.render(snapshot)["combined"][..., 0].mean()


@pytest.mark.parametrize("bounces", [1, 2, 4, 8])
def test_a_furnace_sums_the_powers_of_its_albedo(bounces):
    """What emits is met one bounce further than what reflects, as Cycles counts.  Twelve edges, at whose ends rays graze
    both walls, lose a part in a thousand."""
    snapshot = inside(bounces)
    room(snapshot, diffuse(snapshot, ALBEDO, EMITTED))
    powers = sum(ALBEDO**k for k in range(bounces + 2))
    assert mean(snapshot) == pytest.approx(EMITTED * powers, rel=0.003)


def test_no_bounces_cost_nothing():
    """Meshes that shine are lamps."""
    snapshot = inside(0)
    room(snapshot, diffuse(snapshot, ALBEDO, EMITTED))
    rendered = s.render(snapshot)
    assert rendered["statistics"]["rays_bounce"] == 0
    assert rendered["combined"][..., 0].mean() == pytest.approx(EMITTED * (1 + ALBEDO), rel=0.003)


def test_limits_of_diffuse_and_glossy_bounces_are_their_own():
    snapshot = inside(8, diffuse_bounces=1)
    room(snapshot, diffuse(snapshot, ALBEDO, EMITTED))
    assert mean(snapshot) == pytest.approx(1.0 + ALBEDO + ALBEDO**2, rel=0.003)
    snapshot = inside(8, diffuse_bounces=0, glossy_bounces=0)
    room(snapshot, mirror(snapshot))
    assert mean(snapshot) == 0.0


@pytest.mark.parametrize("bounces", [0, 1, 3])
def test_a_lamp_may_light_what_is_seen_after_few_bounces_alone(bounces):
    """A lamp's own limit is that of all ways where it alone shines."""

    def lit(limit, **own):
        snapshot = inside(limit)
        room(snapshot, diffuse(snapshot, ALBEDO))
        place = np.eye(4)
        place[:3, 3] = (0.0, 0.3, 0.2)
        lamp = {"name": "Lamp", "kind": "POINT", "color": (1, 1, 1), "energy": 100.0}
        snapshot["lights"] = [{**lamp, "world_from_light": place[None], **own}]
        return mean(snapshot)

    limited = lit(bounces)
    assert lit(8, most_bounces=bounces) == pytest.approx(limited, rel=0.005)
    assert lit(8) > 1.05 * limited


@pytest.mark.parametrize("most", [0, 1])
def test_mirrors_show_a_lamp_after_any_bounces(most):
    """All walls are mirrors around a ball that shines: what meets it is the lamp's surface, which asks for no sample."""

    def seen(**own):
        snapshot = inside(8)
        room(snapshot, mirror(snapshot))
        place = np.eye(4)
        place[:3, 3] = (0.0, 0.3, 0.2)
        lamp = {"name": "Lamp", "kind": "POINT", "color": (1, 1, 1), "energy": 100.0}
        lamp |= {"radius": 0.2, "soft_falloff": False}
        snapshot["lights"] = [{**lamp, "world_from_light": place[None], **own}]
        return mean(snapshot)

    unlimited = seen()
    assert unlimited > 0.0
    # No sample is another for the limit: what a mirror meets is not weighed.
    assert seen(most_bounces=most) == pytest.approx(unlimited, rel=1e-6)


def test_a_lamp_that_diffuse_rays_alone_see_is_met_by_them_after_its_bounces():
    """A mirror shows a wall beside a panel, which no other ray could meet: what else sees it makes no difference."""

    def seen(**own):
        snapshot = s.orthographic((16, 16), bounces=1)
        s.quad(snapshot, s.rectangle(-50, -50, 66, 66, 20.0), mirror(snapshot))
        s.quad(snapshot, s.rectangle(-50, -50, 66, 66, -100.0), diffuse(snapshot, ALBEDO))
        place = np.eye(4)
        place[:3, 3] = (58.0, 8.0, -70.0)
        lamp = {"name": "Lamp", "kind": "AREA", "color": (1, 1, 1), "energy": 1e6}
        lamp |= {"shape": "SQUARE", "size": (40.0, 40.0), "world_from_light": place[None]}
        snapshot["lights"] = [{**lamp, "most_bounces": 0, **own}]
        return mean(snapshot)

    hidden = ("visible_glossy", "visible_transmission", "visible_volume")
    everyone = seen()
    assert everyone > 0.0
    assert seen(**dict.fromkeys(hidden, False)) == everyone
    assert seen(visible_diffuse=False) == 0.0


def test_most_that_a_way_brings():
    """The walls are lamps to each other: 2.5.  Each way then brings half of that in three colours, 3.75: a clamp to .75
    leaves .25 of 1.25, whatever noise there is."""
    snapshot = inside(1, clamp_indirect=0.75)
    room(snapshot, diffuse(snapshot, ALBEDO, 5.0))
    assert mean(snapshot) == pytest.approx(5.0 + 2.5 + 0.25, rel=0.003)


def reflected_square(**options):
    """A mirror across the frame, half of which shows a square that hangs behind the camera."""
    snapshot = s.orthographic((64, 64), samples=16, bounces=4, **options)
    s.quad(snapshot, s.rectangle(-8, -8, 72, 72, z=100.0), mirror(snapshot, 0.8))
    return snapshot


def test_a_mirror_shows_what_is_before_it():
    """The camera looks straight at it: the square stands where it would be seen, at four fifths."""
    snapshot = reflected_square()
    s.quad(snapshot, s.rectangle(16, 24, 48, 40, z=-50.0), s.emission(snapshot))
    seen = s.render(snapshot)["combined"][..., 0]
    rows, columns = np.mgrid[0:64, 0:64]
    # Raster rows run downwards or upwards alike: the square is symmetric about the middle.
    covered = (columns >= 16) & (columns < 48) & (rows >= 24) & (rows < 40)
    edge = np.zeros_like(covered)
    edge[:, [15, 16, 47, 48]] = edge[[23, 24, 39, 40]] = True
    assert seen[covered & ~edge] == pytest.approx(0.8, abs=1e-5)
    assert seen[~covered & ~edge].max() <= 1e-5
    assert seen.mean() == pytest.approx(0.8 * 32 * 16 / 64**2, rel=0.02)


def test_what_moves_is_blurred_in_a_mirror():
    """A square of 16 pixels that goes 16: a trapezoid, at each place the part of the shutter that it is there for."""
    snapshot = reflected_square(light_samples=64)
    ways = [s.translation(-8.0), s.translation(8.0)]
    s.quad(
        snapshot,
        s.rectangle(24, -8, 40, 72, z=-50.0),
        s.emission(snapshot),
        transforms=ways,
    )
    seen = s.render(snapshot)["combined"][8:56, :, 0].mean(axis=0) / 0.8
    place = np.arange(64) + 0.5
    truth = np.clip(np.minimum(place - 16, 48 - place) / 16, 0.0, 1.0)
    # A row's mean of 48 pixels with 16 samples of their own: .5 / sqrt(768) = .018 at most.
    assert np.abs(seen - truth).max() <= 4 * 0.018


def test_light_passes_what_is_transparent():
    """A pane of a quarter's opacity before the square that a mirror shows."""
    snapshot = reflected_square()
    s.quad(snapshot, s.rectangle(-8, -8, 72, 72, z=-50.0), s.emission(snapshot))
    pane = s.emission(snapshot, (0, 0, 0), alpha=0.25)
    s.quad(snapshot, s.rectangle(-8, -8, 72, 72, z=-20.0), pane)
    snapshot["options"]["light_samples"] = 64
    # The camera, which has no place in an orthographic view, looks from before the pane.
    assert mean(snapshot) == pytest.approx(0.8 * 0.75, abs=0.02)


def test_hair_and_points_are_seen_in_mirrors():
    """A strand 10 pixels wide across the frame, a sphere of radius 8."""
    snapshot = reflected_square()
    shines = s.emission(snapshot)
    strand = np.linspace((-8, 16, -50), (72, 16, -50), 5)
    curves(snapshot, strand, [5], 5.0, shines)
    cloud(snapshot, [(32, 44, -50)], 8.0, shines)
    area = 64 * 10 + np.pi * 8**2
    assert mean(snapshot) == pytest.approx(0.8 * area / 64**2, rel=0.02)


@pytest.mark.parametrize("kind", ["strand", "points"])
def test_hair_and_points_are_lit_by_what_they_see(kind):
    """In a furnace of radiance 1 they reflect their albedo, but for what they hide from themselves.  Small ones have
    few of the light samples: one frame is off by up to a tenth."""
    snapshot = inside(1, light_samples=256)
    room(snapshot, s.emission(snapshot))
    grey = diffuse(snapshot, ALBEDO)
    if kind == "strand":
        curves(snapshot, np.linspace((-0.9, 0, 0.5), (0.9, 0, 0.5), 5), [5], 0.1, grey)
    else:
        cloud(snapshot, [(0, 0, 0.5)], 0.1, grey)
    seen = []
    for snapshot["options"]["seed"] in range(8):
        seen.append(s.render(snapshot)["combined"][15:17, 15:17, 0])
    assert np.mean(seen) == pytest.approx(ALBEDO, rel=0.03)


def test_what_casts_no_shadow_is_seen_in_mirrors():
    snapshot = reflected_square()
    s.quad(snapshot, s.rectangle(-8, -8, 72, 72, z=-50.0), s.emission(snapshot))
    snapshot["instances"]["flags"] = [59, 59 - 2]
    assert mean(snapshot) == pytest.approx(0.8, abs=1e-5)


@pytest.mark.parametrize(("flags", "seen"), [(59 - 16, 0.0), (59 - 8 - 32, 0.8)])
def test_what_is_hidden_from_a_type_of_ray_is_not_seen_by_it(flags, seen):
    snapshot = reflected_square()
    s.quad(snapshot, s.rectangle(-8, -8, 72, 72, z=-50.0), s.emission(snapshot))
    snapshot["instances"]["flags"] = [59, flags]
    assert mean(snapshot) == pytest.approx(seen, abs=1e-5)


def sheets(count, **limits):
    """Of glass without an index, one behind the other, before what shines."""
    snapshot = s.orthographic((16, 16), samples=16, bounces=8, glossy_bounces=0, **limits)
    nodes = [{"type": "ShaderNodeBsdfRefraction", "inputs": {"IOR": 1.0, "Roughness": 0.0}}]
    glass = material(snapshot, nodes, (0, "BSDF"))
    for i in range(count):
        s.quad(snapshot, s.rectangle(-8, -8, 24, 24, z=10.0 + i), glass)
    s.quad(snapshot, s.rectangle(-8, -8, 24, 24, z=50.0), s.emission(snapshot))
    return snapshot


@pytest.mark.parametrize(("limit", "seen"), [(0, 0.0), (1, 0.0), (2, 1.0), (3, 1.0)])
def test_what_goes_through_has_a_limit_of_its_own(limit, seen):
    """The third sheet is met after two, and shows what is behind it as a lamp is shown."""
    assert mean(sheets(3, transmission_bounces=limit)) == pytest.approx(seen, abs=1e-5)


@pytest.mark.parametrize(("hidden", "seen"), [(32, 0.0), (16, 1.0), (16 + 32, 0.0)])
def test_rays_through_a_surface_are_not_glossy_to_what_they_meet(hidden, seen):
    """Of what is no lamp; what has no light itself: test_hidden_things.py."""
    snapshot = sheets(1)
    snapshot["materials"][-1] = varying_emission()
    snapshot["instances"]["flags"] = [59, 59 - hidden]
    assert mean(snapshot) == pytest.approx(seen, abs=1e-5)


def varying_emission():
    """Of radiance 1, as no lamp is: by a texture whose colours are the same, though rays are told apart."""
    inputs = {"Color1": (1.0,) * 4, "Color2": (1.0,) * 4, "Scale": ("LINK", 0, "Is Glossy Ray")}
    nodes = [
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {"type": "ShaderNodeTexChecker", "inputs": inputs},
        {"type": "ShaderNodeEmission", "inputs": {"Color": ("LINK", 1, "Color")}},
    ]
    return {"name": "Shines", "nodes": nodes, "surface": (2, "Emission")}


def test_saturated_colours_keep_to_themselves():
    """Squares of pure red and of white, a gloss of a twentieth over them, in a furnace: of what red ones get of green and
    blue nothing is known, and neighbours tell nothing of the gloss."""
    gloss = 0.05
    snapshot = inside(1, light_samples=4)
    room(snapshot, len(snapshot["materials"]))
    snapshot["materials"].append(varying_emission())
    colors = {"Color1": (1.0, 0.0, 0.0, 1.0), "Color2": (1.0,) * 4, "Scale": 10.0}
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeTexChecker", "inputs": {**colors, "Vector": ("LINK", 0, "Object")}},
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": ("LINK", 1, "Color")}},
        {"type": "ShaderNodeBsdfGlossy", "inputs": {"Color": (1.0,) * 4, "Roughness": 0.2}},
        {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": gloss,
                "Shader": ("LINK", 2, "BSDF"),
                "Shader_001": ("LINK", 3, "BSDF"),
            },
        },
    ]
    square = s.rectangle(-0.4, -0.4, 0.4, 0.4, z=0.5)
    s.quad(snapshot, square, material(snapshot, nodes, (4, "Shader")))
    seen = s.render(snapshot)["combined"][5:27, 5:27]
    # Samples of the gloss leave noise, as much as itself at most.
    assert np.abs(seen[..., 0] - 1.0).max() < gloss
    green = seen[..., 1]
    assert green.min() > 0.0 and green.max() < 1.0 + gloss
    assert green.mean() == pytest.approx(0.5 + gloss / 2, rel=0.02)


@pytest.mark.parametrize("side", [39.5, 40.0])
@pytest.mark.parametrize("dicing_rate", [1.0, 2.0])
def test_the_foot_of_a_wall_is_not_darker_than_what_it_sees(dicing_rate, side):
    """A black wall goes through the floor, whose points inside it are dark, however near they are to its side.  Beside it
    the floor sees a sky of radiance 1 but for what the wall hides, (1 - x / sqrt(x^2 + h^2)) / 2 at a distance x."""
    snapshot = s.orthographic(
        (64, 64), samples=16, bounces=1, light_samples=256, dicing_rate=dicing_rate
    )
    snapshot["materials"].append(varying_emission())
    shining = len(snapshot["materials"]) - 1
    s.quad(snapshot, s.rectangle(-3000, -3000, 3000, 3000, z=-50.0), shining)
    s.quad(snapshot, s.rectangle(-200, -200, 264, 264, z=100.0), diffuse(snapshot, ALBEDO))
    height = 10.0
    corners = [(x, y, z) for z in (100 - height, 101) for y in (-200, 264) for x in (24.4, side)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    s.mesh(snapshot, np.array(corners, float), faces, diffuse(snapshot, 0.0))
    seen = s.render(snapshot)["combined"][16:48, :, 0].mean(axis=0)
    x = np.arange(40, 60) + 0.5 - side
    expected = ALBEDO * (1 - 0.5 * (1 - x / np.hypot(x, height)))
    # Neighbours share over two steps of the grid, in which the light of the first pixels falls by this.
    assert seen[40:60] == pytest.approx(expected, rel=0.03 * dicing_rate)


def test_the_foot_of_a_wall_that_moves():
    """The same wall, WIDTH wide, moves over the floor: what it uncovers is lit as it is while the wall is elsewhere, not
    as inside of it."""
    height, width, begin, way = 10.0, 12.0, 16.0, 24.0
    snapshot = s.orthographic((64, 64), samples=64, bounces=1, light_samples=64)
    snapshot["materials"].append(varying_emission())
    shining = len(snapshot["materials"]) - 1
    s.quad(snapshot, s.rectangle(-3000, -3000, 3000, 3000, z=-50.0), shining)
    s.quad(snapshot, s.rectangle(-200, -200, 264, 264, z=100.0), diffuse(snapshot, ALBEDO))
    corners = [(x, y, z) for z in (100 - height, 101) for y in (-200, 264) for x in (0, width)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    moved = [s.translation(begin), s.translation(begin + way)]
    s.mesh(snapshot, np.array(corners, float), faces, diffuse(snapshot, 0.0), transforms=moved)
    seen = s.render(snapshot)["combined"][16:48, :, 0].mean(axis=0)
    times = (np.arange(4096) + 0.5) / 4096
    left = begin + way * times
    x = np.arange(8, 60)[:, None] + 0.5
    away = np.maximum(left - x, x - left - width)
    expected = (away > 0) * ALBEDO * (0.5 + 0.5 * away / np.hypot(away, height))
    # Without a pixel in which its sides stand at the shutter's ends.
    ends = np.isin(x[:, 0], [15.5, 16.5, 27.5, 28.5, 39.5, 40.5, 51.5, 52.5])
    assert seen[8:60][~ends] == pytest.approx(expected.mean(axis=1)[~ends], rel=0.03)


@pytest.mark.parametrize("bounces", [0, 4])
def test_what_bent_normals_send_into_their_own_surface_is_lost(bounces):
    """A white square in a white world, its normals 45 degrees from its own: of their hemisphere (1 + cos 45) / 2 is before
    the surface.  What is behind it would see the surface once more."""
    snapshot = s.orthographic((16, 16), samples=16, bounces=bounces, light_samples=256)
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    bent = np.tile(np.array([0.5**0.5, 0.0, 0.5**0.5], np.float32), (4, 1))
    s.quad(snapshot, s.rectangle(-99, -99, 99, 99), diffuse(snapshot, 1.0), corner_normals=bent)
    assert mean(snapshot) == pytest.approx((1 + 0.5**0.5) / 2, rel=0.005)


def colored_room(**options):
    snapshot = inside(4, **options)
    room(snapshot, diffuse(snapshot, ALBEDO, EMITTED))
    s.mesh(
        snapshot,
        np.array([(-0.3, -0.4, 0.7), (0.4, -0.3, 0.6), (0.0, 0.4, 0.8)]),
        [(0, 1, 2)],
        mirror(snapshot, 0.9),
    )
    return s.render(snapshot)["combined"]


def test_bits_do_not_depend_on_buckets_and_threads():
    whole = colored_room()
    assert np.array_equal(whole, colored_room(bucket_size=16))
    assert np.array_equal(whole, colored_room(threads=1))
    assert np.array_equal(whole[8:24, 4:20], colored_room(crop=np.int32([4, 8, 20, 24])))


@pytest.mark.parametrize("size", [1e-4, 1e5])
def test_rooms_of_any_size_are_as_bright(size):
    snapshot = inside(4)
    snapshot["camera"]["clip"] = (size / 10, size * 10)
    room(snapshot, diffuse(snapshot, ALBEDO, EMITTED), half=size)
    assert mean(snapshot) == pytest.approx(sum(ALBEDO**k for k in range(6)), rel=0.004)


def test_what_a_material_is_not_drawn_with_is_named_once():
    """Whatever rays see it; of what the camera does not see, too."""
    snapshot = inside(0)
    nodes = [
        {"type": "ShaderNodeUnheardOf", "inputs": {}},
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Roughness": ("LINK", 0, "Value")}},
        {
            "type": "ShaderNodeBsdfHairPrincipled",
            "inputs": {},
            "properties": {"model": "HUANG"},
        },
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {
            "type": "ShaderNodeMixShader",
            "inputs": {
                "Fac": ("LINK", 3, "Is Camera Ray"),
                "Shader": ("LINK", 2, "BSDF"),
                "Shader_001": ("LINK", 1, "BSDF"),
            },
        },
    ]
    room(snapshot, material(snapshot, nodes, (4, "Shader")))

    def warnings(bounces):
        snapshot["options"]["bounces"] = bounces
        return {message: count for _, message, count in s.render(snapshot)["warnings"]}

    seen, met = warnings(0), warnings(1)
    assert list(seen.values()) == [1] and "ShaderNodeUnheardOf" in next(iter(seen))
    new = {message: count for message, count in met.items() if message not in seen}
    assert {message: met[message] for message in seen} == seen
    assert list(new.values()) == [1] and "Huang" in next(iter(new))


def test_two_mirrors_end():
    """Facing each other, with nothing else to see."""
    snapshot = reflected_square(glossy_bounces=1000)
    snapshot["options"]["bounces"] = 64
    s.quad(snapshot, s.rectangle(-8, -8, 72, 72, z=-50.0), mirror(snapshot))
    assert mean(snapshot) == 0.0
