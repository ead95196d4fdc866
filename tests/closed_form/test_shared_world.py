# SPDX-License-Identifier: GPL-3.0-or-later
"""Where light is followed, what the world sends between surfaces is shared by neighbours as theirs is: it stays what it
was, in all passes, with less noise."""

import numpy as np
import pytest
import snapshots as s
from snapshots import link
from test_bounces import ALBEDO, diffuse, material
from test_world_light import COORDINATES, ENVIRONMENT, background


def beside_a_wall(wall=0.0, **options):
    """A floor under a sky, and a wall 10 pixels high, black if nothing else is said, that ends at x = 24."""
    snapshot = s.orthographic((64, 64), samples=16, **{"bounces": 1, **options})
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    s.quad(snapshot, s.rectangle(-200, -200, 264, 264, z=100.0), diffuse(snapshot, ALBEDO))
    corners = [(x, y, z) for z in (90, 99.99) for y in (-200, 264) for x in (-200, 24)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    s.mesh(snapshot, np.array(corners, float), faces, diffuse(snapshot, wall))
    return snapshot


X = np.arange(26, 64)
AWAY = X + 0.5 - 24


def expected():
    """The wall hides (1 - x / sqrt(x^2 + h^2)) / 2 of the sky at a distance x."""
    return ALBEDO * (1 - 0.5 * (1 - AWAY / np.hypot(AWAY, 10.0)))


def test_a_floor_beside_a_wall_sees_its_part_of_the_sky():
    seen = s.render(beside_a_wall(light_samples=64))["combined"][:, X, 0]
    assert seen.mean(axis=0) == pytest.approx(expected(), rel=0.02)


@pytest.mark.parametrize("light_samples", [1, 2, 4])
def test_few_samples_see_as_much_of_it(light_samples):
    """Eight pictures of 64 x 38 pixels.  How far a point shares is not to be told by what it has found itself: points
    whose only ray meets nothing would tell more neighbours than those whose ray meets the wall."""
    pictures = [
        s.render(beside_a_wall(light_samples=light_samples, seed=seed))["combined"][:, X, 0].mean()
        for seed in range(8)
    ]
    # A pixel's rays are .4 off at most: of 19,456 pixels' .3 %.
    assert np.mean(pictures) == pytest.approx(expected().mean(), rel=0.006)


def test_four_samples_of_the_sky_leave_little_noise():
    """Deviations of the mean of 64 by 38 pixels between the wall and the open; alone each point takes its own samples."""
    alone, shared = (
        (
            s.render(beside_a_wall(light_samples=4, bounces=n))["combined"][:, X, 0] / expected()
        ).std()
        for n in (0, 1)
    )
    assert shared < 0.6 * alone


def test_passes_tell_the_sky_from_surfaces():
    """The wall sends nothing: all light is direct, though it was gathered together."""
    snapshot = beside_a_wall(light_samples=16)
    names = ["Combined", "Diffuse Direct", "Diffuse Indirect"]
    snapshot["options"]["passes"] = names
    made = s.render(snapshot)
    direct, indirect = (made["passes"][name][:, X] for name in names[1:])
    assert np.abs(indirect).max() < 1e-6
    assert direct * ALBEDO == pytest.approx(made["combined"][:, X, :3], abs=1e-5)


def test_direct_and_indirect_are_all_and_neither_is_negative():
    snapshot = beside_a_wall(wall=0.8, light_samples=4)
    snapshot["options"]["passes"] = ["Combined", "Diffuse Direct", "Diffuse Indirect"]
    made = s.render(snapshot)
    direct, indirect = (made["passes"][f"Diffuse {n}"][:, X] for n in ("Direct", "Indirect"))
    assert indirect.min() >= 0 and 0.01 < indirect.mean() < 0.2
    assert (direct + indirect) * ALBEDO == pytest.approx(made["combined"][:, X, :3], abs=1e-5)


def test_bits_do_not_depend_on_buckets_threads_and_passes():
    whole = s.render(beside_a_wall(light_samples=4))["combined"]
    for options in ({"bucket_size": 16}, {"threads": 1}, {"passes": ["Combined", "Normal"]}):
        assert np.array_equal(
            whole, s.render(beside_a_wall(light_samples=4, **options))["combined"]
        )


def lower_half(snapshot):
    """Black where the floor looks from its far side."""
    s.constant_world(snapshot, 1.0)
    above = {"operation": "LESS_THAN"}
    snapshot["world"]["nodes"] = [
        COORDINATES,
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Generated")}},
        {"type": "ShaderNodeMath", "inputs": {"Value": link(1, "Z")}, "properties": above},
        background(link(2, "Value")),
    ]
    snapshot["world"]["nodes"][2]["inputs"]["Value_001"] = 0.0
    snapshot["world"] |= {"surface": (3, "Background"), "lights_scene": True}


def grey_sky(snapshot):
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True


def one_bright_side(snapshot):
    level = np.full((8, 16), 0.1, np.float32)
    level[1:3, 3:9] = 4.0
    pixels = np.ones((8, 16, 4), np.float32)
    pixels[..., :3] = level[..., None]
    image = {"name": "I", "path": "", "colorspace": "scene_linear", "alpha_mode": "STRAIGHT"}
    snapshot["images"] = [image | {"pixels": pixels}]
    snapshot["world"] = {
        "name": "World",
        "nodes": [COORDINATES, ENVIRONMENT, background(link(1, "Color"))],
        "surface": (2, "Background"),
    }


def stripes(kind, bounces):
    """Of 4 pixels, that reflect, and others that let light through, or look aside by 60 degrees, under half a sky."""
    snapshot = s.orthographic((32, 32), samples=64, light_samples=64, bounces=bounces)
    lower_half(snapshot)
    white = {"Color": (1.0, 1.0, 1.0, 1.0)}
    wave = [
        {"type": "ShaderNodeNewGeometry", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": link(0, "Position")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": link(1, "X"), "Value_001": 8.0},
            "properties": {"operation": "FLOORED_MODULO"},
        },
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": link(2, "Value"), "Value_001": 4.0},
            "properties": {"operation": "GREATER_THAN"},
        },
    ]
    if kind == "Translucent":
        other = [{"type": "ShaderNodeBsdfTranslucent", "inputs": white}]
    else:
        aside = {"X": 0.75**0.5, "Y": 0.0, "Z": -0.5}
        other = [
            {"type": "ShaderNodeCombineXYZ", "inputs": aside},
            {"type": "ShaderNodeBsdfDiffuse", "inputs": white | {"Normal": link(5, "Vector")}},
        ]
    nodes = [*wave, {"type": "ShaderNodeBsdfDiffuse", "inputs": white}, *other]
    mix = {"Fac": link(3, "Value"), "Shader": link(4, "BSDF")}
    mix |= {"Shader_001": link(len(nodes) - 1, "BSDF")}
    nodes.append({"type": "ShaderNodeMixShader", "inputs": mix})
    surface = material(snapshot, nodes, (len(nodes) - 1, "Shader"))
    s.quad(snapshot, s.rectangle(-48, -48, 80, 80, 20.0), surface)
    return s.render(snapshot)["combined"][..., 0].mean(axis=0)


@pytest.mark.parametrize("kind", ["Translucent", "bent"])
def test_lobes_that_look_elsewhere_share_no_world(kind):
    """Nothing else is there: following light changes nothing."""
    alone = stripes(kind, 0)
    assert alone[1:3] == pytest.approx(1.0, rel=0.005) and alone[5:7].max() < 0.7
    assert stripes(kind, 1) == pytest.approx(alone, abs=0.01)


def brighter_in_gloss(snapshot):
    """Rays that glossy lobes send see twice as much."""
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["nodes"] = [
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": link(0, "Is Glossy Ray"), "Value_001": 1.0},
            "properties": {"operation": "ADD"},
        },
        background(link(1, "Value")),
    ]
    snapshot["world"] |= {"surface": (2, "Background"), "lights_scene": True}


def checks(bounces, world):
    """A floor of white and nearly black checks of 4 pixels under a gloss."""
    snapshot = s.orthographic((32, 32), samples=64, light_samples=64, bounces=bounces)
    world(snapshot)
    colors = {"Color1": (0.8, 0.8, 0.8, 1.0), "Color2": (0.01, 0.01, 0.01, 1.0)}
    nodes = [
        {"type": "ShaderNodeNewGeometry", "inputs": {}},
        {
            "type": "ShaderNodeTexChecker",
            "inputs": {"Vector": link(0, "Position"), "Scale": 0.25, **colors},
        },
        {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": link(1, "Color")}},
        {
            "type": "ShaderNodeBsdfGlossy",
            "inputs": {"Color": (0.1, 0.1, 0.1, 1.0), "Roughness": 0.7},
        },
        {
            "type": "ShaderNodeAddShader",
            "inputs": {"Shader": link(2, "BSDF"), "Shader_001": link(3, "BSDF")},
        },
    ]
    s.quad(snapshot, s.rectangle(-50, -50, 90, 90, 20.0), material(snapshot, nodes, (4, "Shader")))
    return s.render(snapshot)["combined"][..., 0]


@pytest.mark.parametrize("world", [grey_sky, one_bright_side, lower_half, brighter_in_gloss])
def test_checks_share_no_light_and_stay_sharp(world):
    """Nothing else is there: following light changes nothing, on either kind of check or between them."""
    alone, followed = checks(0, world), checks(4, world)
    white = alone > alone.mean()
    assert 0.3 < white.mean() < 0.7
    for kind in (white, ~white):
        assert followed[kind].mean() == pytest.approx(alone[kind].mean(), rel=0.005)
    assert np.sqrt(np.mean((followed - alone) ** 2)) < 0.015 * alone.mean()
