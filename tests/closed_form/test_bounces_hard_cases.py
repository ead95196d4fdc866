# SPDX-License-Identifier: GPL-3.0-or-later
"""Where light that bounces goes wrong: leaks, contacts, keyholes, glass around the eye, albedo 1, great distances."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import ALBEDO, diffuse, inside, material, mean, mirror, room
from test_displacement import onto_a_ball
from test_elements import cloud

BLACK = 0.0


def white_world(snapshot, strength=1.0):
    s.constant_world(snapshot, strength)
    snapshot["world"]["lights_scene"] = True


@pytest.mark.parametrize("dicing_rate", [0.5, 1.0, 4.0])
def test_no_light_leaks_into_a_closed_box(dicing_rate):
    """Six white planes that meet at their edges, each a mesh of its own, in a world of radiance 1000."""
    snapshot = inside(4, dicing_rate=dicing_rate)
    white_world(snapshot, 1000.0)
    white = diffuse(snapshot, 1.0)
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    for face in [
        (0, 1, 3, 2),
        (4, 6, 7, 5),
        (0, 4, 5, 1),
        (2, 3, 7, 6),
        (0, 2, 6, 4),
        (1, 5, 7, 3),
    ]:
        s.mesh(snapshot, corners[list(face)], [(0, 1, 2, 3)], white)
    assert s.render(snapshot)["combined"][..., :3].max() == 0.0


def test_neighbours_share_no_light_through_a_thin_wall():
    """One floor under two rooms, of which one has a ceiling that shines."""
    snapshot = s.orthographic((64, 64), samples=16, bounces=3, light_samples=16)
    grey, black = diffuse(snapshot, ALBEDO), diffuse(snapshot, BLACK)
    shines = s.emission(snapshot)
    top, floor, out = -1.0, 40.0, 80
    s.quad(snapshot, s.rectangle(-16, -16, out, out, floor), grey)
    s.quad(snapshot, s.rectangle(-16, -16, 32, out, top), shines)
    s.quad(snapshot, s.rectangle(32, -16, out, out, top), black)
    for x in (-16, 32, out):
        side = [(x, -16, top), (x, out, top), (x, out, floor), (x, -16, floor)]
        s.quad(snapshot, side, grey)
    for y in (-16, out):
        side = [(-16, y, top), (out, y, top), (out, y, floor), (-16, y, floor)]
        s.quad(snapshot, side, grey)
    seen = s.render(snapshot)["combined"][..., 0]
    assert seen[:, :31].min() > 0.15
    # The pixel after the wall has corners of micropolygons under it.  One way of 100,000 meets a wall
    # within rounding of its edge and leaves from behind the other: with 8 seeds .0011 at most.
    assert seen[:, 33:].max() < 0.01 * seen[:, :31].min()


@pytest.mark.parametrize("place", [0.0, 1e5])
@pytest.mark.parametrize("bounces", [1, 4])
def test_a_furnace_of_albedo_1_and_far_away(place, bounces):
    """What shines is lit by itself once more a bounce."""
    snapshot = inside(bounces)
    far = s.translation(place, -place, place)
    snapshot["camera"]["world_from_camera"] = far[None]
    room(snapshot, diffuse(snapshot, 1.0, 1.0), transforms=[far])
    assert mean(snapshot) == pytest.approx(bounces + 2, rel=0.005)


def within_glass(roughness, place):
    """What an eye sees within a ball of glass in a white world."""
    snapshot = inside(16, transmission_bounces=16)
    snapshot["camera"]["world_from_camera"] = s.translation(*place)[None]
    white_world(snapshot)
    inputs = {"Color": (1.0,) * 4, "Roughness": roughness, "IOR": 1.5}
    node = {
        "type": "ShaderNodeBsdfGlass",
        "inputs": inputs,
        "properties": {"distribution": "MULTI_GGX"},
    }
    glass = material(snapshot, [node], (0, "BSDF"))
    angle = np.arange(65) * np.pi / 32
    height = np.arange(33) * np.pi / 32
    ring = np.stack(np.meshgrid(height, angle, indexing="ij"), -1)
    points = np.stack(
        [
            np.sin(ring[..., 0]) * np.cos(ring[..., 1]),
            np.sin(ring[..., 0]) * np.sin(ring[..., 1]),
            np.cos(ring[..., 0]),
        ],
        -1,
    )
    faces = [
        (65 * i + j, 65 * (i + 1) + j, 65 * (i + 1) + j + 1, 65 * i + j + 1)
        for i in range(1, 31)
        for j in range(64)
    ]
    s.mesh(snapshot, points.reshape(-1, 3), faces, glass)
    return mean(snapshot)


def test_an_eye_within_glass():
    """In the middle, which every ray meets straight on: what is reflected goes the same way back, and all leaves at last."""
    # The poles of the ball are open: the view does not reach them.  Seeds deviate by 1e-4.
    assert within_glass(0.0, (0, 0, 0)) == pytest.approx(1.0, abs=4e-4)


@pytest.mark.parametrize("roughness", [0.6, 1.0])
def test_an_eye_within_rough_glass(roughness):
    """Off the middle, where smooth glass would let most ways out nowhere: were rough glass asked as seldom as that lets
    light through, .38 and .25 were left.  Seeds deviate by .01."""
    assert within_glass(roughness, (0.8, 0, 0)) == pytest.approx(1.0, abs=0.04)


def integral_over(square, height, place, steps=200):
    """Form factor of a square [x0, y0, x1, y1] seen from below, from a horizontal place."""
    x0, y0, x1, y1 = square
    x = x0 + (x1 - x0) * (np.arange(steps) + 0.5) / steps - place[0]
    y = y0 + (y1 - y0) * (np.arange(steps) + 0.5) / steps - place[1]
    squared = x[:, None] ** 2 + y[None] ** 2 + height**2
    return (height**2 / (np.pi * squared**2)).sum() * (x1 - x0) * (y1 - y0) / steps**2


def test_a_lamp_behind_a_keyhole():
    """What shines is far larger than the hole that all its light comes through."""
    snapshot = s.orthographic((32, 32), samples=16, bounces=2, light_samples=64)
    shines, black = s.emission(snapshot), diffuse(snapshot, BLACK)
    s.quad(snapshot, s.rectangle(-400, -400, 432, 432, -60.0), shines)
    frame = (-400, 10, 22, 432)
    for i, x in enumerate(frame[:-1]):
        for j, y in enumerate(frame[:-1]):
            if (i, j) != (1, 1):
                s.quad(snapshot, s.rectangle(x, y, frame[i + 1], frame[j + 1], -10.0), black)
    s.quad(snapshot, s.rectangle(0, 0, 32, 32, 20.0), diffuse(snapshot, ALBEDO))
    expected = np.mean(
        [
            integral_over((10, 10, 22, 22), 30.0, (x, y))
            for x in range(2, 32, 4)
            for y in range(2, 32, 4)
        ]
    )
    # 65,536 rays of the surface's own, of which so many pass: four deviations.
    doubt = 4 / np.sqrt(expected * 32 * 32 * 64)
    assert mean(snapshot) == pytest.approx(ALBEDO * expected, rel=doubt)


def test_a_thousand_lamps_are_as_bright_as_what_they_tile():
    snapshot = s.orthographic((16, 16), samples=16, bounces=2, light_samples=64)
    shines = s.emission(snapshot)
    square = s.quad(snapshot, s.rectangle(0, 0, 2, 2, -10.0), shines)
    for i in range(32):
        for j in range(32):
            if i or j:
                s.instance(snapshot, square, shines, [s.translation(2 * i, 2 * j)])
    center = [s.translation(24, 24)]
    snapshot["camera"]["world_from_camera"] = np.array(center)
    s.quad(snapshot, s.rectangle(0, 0, 64, 64, 20.0), diffuse(snapshot, ALBEDO))
    places = [(24 + x, 24 + y) for x in range(1, 16, 2) for y in range(1, 16, 2)]
    expected = np.mean([integral_over((0, 0, 64, 64), 30.0, place) for place in places])
    assert mean(snapshot) == pytest.approx(ALBEDO * expected, rel=0.01)


def in_mirror(**options):
    snapshot = s.orthographic((64, 64), samples=64, bounces=2, **options)
    s.quad(snapshot, s.rectangle(-8, -8, 72, 72, z=100.0), mirror(snapshot))
    return snapshot


def test_the_outline_of_what_is_displaced_in_a_mirror():
    """A cube that its material makes a ball of 20 pixels."""
    snapshot = in_mirror()
    onto = onto_a_ball(snapshot, 20.0)
    nodes = snapshot["materials"][onto]["nodes"]
    nodes[-1] = {"type": "ShaderNodeEmission", "inputs": {"Color": (1.0,) * 4, "Strength": 1.0}}
    snapshot["materials"][onto]["surface"] = (len(nodes) - 1, "Emission")
    room(snapshot, onto, half=10.0, transforms=[s.translation(32, 32, -50)])
    assert mean(snapshot) == pytest.approx(np.pi * 400 / 64**2, rel=0.01)


def test_what_turns_inside_out_in_a_mirror():
    """A square whose width goes through nothing to its mirrored self: at a distance x from its middle it is there for
    1 - x / 24 of the shutter."""
    snapshot = in_mirror(light_samples=64)
    ends = [s.translation(32) @ np.diag((side, 1.0, 1.0, 1.0)) for side in (1.0, -1.0)]
    s.quad(snapshot, s.rectangle(-24, -8, 24, 72, -50.0), s.emission(snapshot), transforms=ends)
    seen = s.render(snapshot)["combined"][8:56, :, 0].mean(axis=0)
    expected = np.clip(1 - np.abs(np.arange(64) + 0.5 - 32) / 24, 0, 1)
    # Of 48 pixels with 64 samples of their own: .5 / sqrt(3072) at most.
    assert np.abs(seen - expected).max() <= 4 * 0.009


def test_an_endless_plane_under_a_sky():
    """It sees nothing of itself, up to the horizon."""
    snapshot = s.perspective((32, 32), 16, samples=16, bounces=4)
    white_world(snapshot)
    plane = [(-1e6, 1.0, -1e6), (-1e6, 1.0, 1e6), (1e6, 1.0, 1e6), (1e6, 1.0, -1e6)]
    s.quad(snapshot, plane, diffuse(snapshot, ALBEDO))
    seen = s.render(snapshot)["combined"][..., 0]
    sky, ground = sorted((seen[:15], seen[17:]), key=lambda half: -half.mean())
    assert sky == pytest.approx(1.0, abs=1e-5)
    # World light is found by samples and by rays, whose shares add up to all but a fiftieth.
    assert ground == pytest.approx(ALBEDO, rel=0.02)


def panes(count, combine, bounces):
    """One behind the other in a world of 1, of sharp Glossy and Transparent, for rays in at most 50 ways a point: those
    that bring a fiftieth of its light, not two to the power of the meetings.  Returns the picture."""
    snapshot = inside(bounces, transparent_bounces=64)
    white_world(snapshot)
    nodes = [
        {"type": "ShaderNodeBsdfGlossy", "inputs": {"Color": (1.0,) * 4, "Roughness": 0.0}},
        {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1.0,) * 4}},
        {
            "type": combine,
            "inputs": {
                "Fac": 0.5,
                "Shader": ("LINK", 0, "BSDF"),
                "Shader_001": ("LINK", 1, "BSDF"),
            },
        },
    ]
    half = material(snapshot, nodes, (2, "Shader"))
    for i in range(count):
        s.quad(snapshot, s.rectangle(-900, -900, 900, 900, 2.0 + i), half)
    rendered = s.render(snapshot)
    statistics = rendered["statistics"]
    assert statistics["rays_bounce"] <= 50 * statistics["points_shaded"]
    return rendered["combined"][..., 0]


def test_half_mirrors_facing_each_other_end():
    seen = panes(4, "ShaderNodeMixShader", 64)
    # Pixels deviate by .13.
    assert seen.mean() == pytest.approx(1.0, abs=4 * 0.13 / 32)


def test_mirrors_added_to_what_is_clear_end():
    """Each sends on twice what comes: of 3 panes and 12 meetings, 761 rays a point if all were followed."""
    panes(3, "ShaderNodeAddShader", 12)
    # Of one, the world behind and the one before.
    assert panes(1, "ShaderNodeAddShader", 1) == pytest.approx(2.0, abs=1e-5)


def under_a_card(flags, **options):
    """A floor below a black card of half its height's size that the camera does not see, in a white world."""
    snapshot = s.orthographic((16, 16), samples=16, light_samples=64, **options)
    white_world(snapshot)
    s.quad(snapshot, s.rectangle(-1000, -1000, 1000, 1000, z=40.0), diffuse(snapshot, ALBEDO))
    s.quad(snapshot, s.rectangle(0, 0, 16, 16, z=32.0), diffuse(snapshot, BLACK))
    snapshot["instances"]["flags"] = [123, flags - 1]
    return s.render(snapshot)


def seen_of_a_card():
    """Form factor of the card's quarters, mean of the pixels (Howell, configuration C-11)."""
    x, y = np.meshgrid(*2 * [(np.arange(160) + 0.5) / 10 - 8])
    quarters = [((8 + i * x) / 8, (8 + j * y) / 8) for i in (-1, 1) for j in (-1, 1)]
    halves = [(a, b) for x, y in quarters for a, b in ((x, y), (y, x))]
    return sum(
        a / np.hypot(1, a) * np.arctan(b / np.hypot(1, a)) / (2 * np.pi) for a, b in halves
    ).mean()


@pytest.mark.parametrize("bounces", [0, 4])
@pytest.mark.parametrize(("flags", "is_met"), [(123, True), (123 - 2, True), (123 - 8, False)])
def test_diffuse_rays_see_a_constant_world_past_what_is_hidden_from_them(flags, is_met, bounces):
    """Whatever casts a shadow: no lamp sends this light, and Cycles' rays that diffuse lobes send find it."""
    seen = under_a_card(flags, bounces=bounces)["combined"][..., 0].mean()
    hidden = seen_of_a_card() if is_met else 0.0
    # 16,384 rays of chance .45 at most: .004 of noise were they not well spread.  Where surfaces send
    # light too, neighbours share it by planes, under which the shadow's middle bends: .009.
    assert seen == pytest.approx(ALBEDO * (1 - hidden), rel=0.012 if bounces else 0.004)


def test_one_ray_tells_of_the_world_and_what_hides_it():
    """Of every sample of a lobe two rays went the same way: one for what it meets, one for the world behind it."""
    result = under_a_card(123, bounces=4)
    assert result["statistics"]["rays_occlusion"] == 0
    assert result["statistics"]["rays_bounce"] > 0


@pytest.mark.parametrize("bounces", [0, 3])
@pytest.mark.parametrize("light_samples", [1, 16])
def test_colours_below_nothing_reflect_nothing(bounces, light_samples):
    """As in Cycles.  A ray's part of a lobe was a quotient of nearly nothing: - 1e36 in every pixel."""
    snapshot = s.orthographic(
        (8, 8), samples=16, bounces=bounces, light_samples=light_samples, clamp_indirect=0.0
    )
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.4, -0.2, 0.1, 1.0)}}]
    snapshot["materials"].append({"name": "Odd", "nodes": nodes, "surface": (0, "BSDF")})
    s.quad(snapshot, s.rectangle(-9, -9, 99, 99), 0)
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    picture = s.render(snapshot)["combined"][..., :3]
    assert np.abs(picture - [0.4, 0.0, 0.1]).max() < 1e-5


NONE_GOES_ON = dict.fromkeys(("diffuse_bounces", "glossy_bounces", "transmission_bounces"), 0)


def test_limits_of_no_bounce_cost_nothing():
    """As Max Bounces 0 is handed over: where all that shines is a lamp no ray looks for more, and the picture is that of
    no bounces to the bit."""
    pictures = []
    for limits in ({"bounces": 1, **NONE_GOES_ON}, {"bounces": 0}):
        snapshot = inside(**limits)
        room(snapshot, diffuse(snapshot, ALBEDO, 1.0))
        rendered = s.render(snapshot)
        assert rendered["statistics"]["rays_bounce"] == 0
        pictures.append(rendered["combined"])
    assert np.array_equal(*pictures)


def test_limits_of_no_bounce_leave_what_shines_and_is_no_lamp():
    """A sphere of a point cloud brings the square of its radius over its distance."""
    snapshot = s.orthographic((16, 16), samples=16, bounces=1, light_samples=256, **NONE_GOES_ON)
    s.quad(snapshot, s.rectangle(-50, -50, 66, 66, 20.0), diffuse(snapshot, ALBEDO))
    cloud(snapshot, [(8.0, 8.0, -180.0)], 100.0, s.emission(snapshot))
    assert mean(snapshot) == pytest.approx(0.25 * ALBEDO, rel=0.02)
