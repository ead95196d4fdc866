# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects hidden from what volumes scatter (Ray Visibility's Volume Scatter) against closed forms."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import material
from test_volumes import box, filled, scatter

SEEN = 1 | 2 | 8 | 16 | 32 | 64
HIDDEN = SEEN - 64
DEPTH = 1.5


def even_emission(snapshot):
    """The same all over: its meshes are lamps."""
    return s.emission(snapshot)


def read_emission(snapshot):
    """1 everywhere as well, by a graph that varies: only ways that meet it find its light."""
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Generated")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 1, "Z"), "Value_001": 0.0, "Value_002": 1.0},
            "properties": {"operation": "MULTIPLY_ADD"},
        },
        {
            "type": "ShaderNodeEmission",
            "inputs": {"Color": (1.0,) * 4, "Strength": ("LINK", 2, "Value")},
        },
    ]
    return material(snapshot, nodes, (3, "Emission"))


def fog_in_a_room(emission, flags):
    """Fog without absorption in a closed room whose walls send out 1: a white furnace."""
    snapshot = s.orthographic(
        (16, 16), samples=256, film_transparent=False, bounces=64, volume_bounces=64
    )
    box(snapshot, (-40, -40, -40), (60, 60, 60), emission(snapshot))
    box(snapshot, (3, 3, 2), (13, 13, 12), filled(snapshot, scatter(DEPTH / 10)))
    snapshot["instances"]["flags"] = [flags, SEEN]
    return s.render(snapshot)["combined"][4:12, 4:12, 0].mean()


@pytest.mark.parametrize("emission", [even_emission, read_emission])
def test_fog_sees_a_room_that_shows_itself(emission):
    # 16,384 ways, each off by less than .5 around the mean.
    assert fog_in_a_room(emission, SEEN) == pytest.approx(1.0, rel=0.015)


@pytest.mark.parametrize("emission", [even_emission, read_emission])
def test_fog_only_dims_a_room_that_is_hidden_from_it(emission):
    """Beer and Lambert's law: what is scattered finds no light to bring."""
    assert fog_in_a_room(emission, HIDDEN) == pytest.approx(np.exp(-DEPTH), rel=1e-3)


def not_for_fog(snapshot):
    """Of radiance 1, but black to what volumes scatter."""
    nodes = [
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": 1.0, "Value_001": ("LINK", 0, "Is Volume Scatter Ray")},
            "properties": {"operation": "SUBTRACT"},
        },
        {
            "type": "ShaderNodeEmission",
            "inputs": {"Color": (1.0,) * 4, "Strength": ("LINK", 1, "Value")},
        },
    ]
    return material(snapshot, nodes, (2, "Emission"))


def test_light_path_tells_what_is_scattered():
    assert fog_in_a_room(not_for_fog, SEEN) == pytest.approx(np.exp(-DEPTH), rel=1e-3)


def world(varies=False, told=False):
    """Sends out 1, to what is scattered as well unless it is `told`; `varies`: by nodes that say so alone."""
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {"type": "ShaderNodeSeparateXYZ", "inputs": {"Vector": ("LINK", 0, "Generated")}},
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 1, "Z") if varies else 0.0, "Value_001": 0.0},
            "properties": {"operation": "MULTIPLY"},
        },
        {"type": "ShaderNodeLightPath", "inputs": {}},
        {
            "type": "ShaderNodeMath",
            "inputs": {
                "Value": 1.0,
                "Value_001": ("LINK", 3, "Is Volume Scatter Ray") if told else 0.0,
            },
            "properties": {"operation": "SUBTRACT"},
        },
        {
            "type": "ShaderNodeMath",
            "inputs": {"Value": ("LINK", 2, "Value"), "Value_001": ("LINK", 4, "Value")},
            "properties": {"operation": "ADD"},
        },
        {
            "type": "ShaderNodeBackground",
            "inputs": {"Color": (1.0,) * 4, "Strength": ("LINK", 5, "Value")},
        },
    ]
    return {"name": "World", "nodes": nodes, "surface": (6, "Background")}


def image_world(snapshot):
    """Sends out 1 by a texture, whose means lighting looks up."""
    image = {"name": "I", "path": "", "colorspace": "scene_linear", "alpha_mode": "STRAIGHT"}
    snapshot["images"] = [image | {"pixels": np.ones((8, 16, 4), np.float32)}]
    nodes = [
        {"type": "ShaderNodeTexCoord", "inputs": {}},
        {
            "type": "ShaderNodeTexEnvironment",
            "inputs": {"Vector": ("LINK", 0, "Generated")},
            "properties": {"image": "I"},
        },
        {
            "type": "ShaderNodeBackground",
            "inputs": {"Color": ("LINK", 1, "Color"), "Strength": 1.0},
        },
    ]
    return {"name": "World", "nodes": nodes, "surface": (2, "Background")}


def fog_under(sky, snapshot=None, bounces=64):
    """Fog without absorption that nothing but the world lights."""
    snapshot = snapshot or fog_alone(bounces)
    snapshot["world"] = sky
    return s.render(snapshot)["combined"][4:12, 4:12, 0].mean()


def fog_alone(bounces=64):
    snapshot = s.orthographic(
        (16, 16), samples=256, film_transparent=False, bounces=bounces, volume_bounces=bounces
    )
    box(snapshot, (3, 3, 2), (13, 13, 12), filled(snapshot, scatter(DEPTH / 10)))
    return snapshot


@pytest.mark.parametrize("varies", [False, True])
def test_fog_sees_a_world_that_shows_itself(varies):
    # As of the room.
    assert fog_under(world(varies)) == pytest.approx(1.0, rel=0.015)


@pytest.mark.parametrize("bounces", [0, 64])
@pytest.mark.parametrize("varies", [False, True])
def test_fog_only_dims_a_world_that_is_hidden_from_it(varies, bounces):
    hidden = world(varies) | {"visible_volume": False}
    assert fog_under(hidden, bounces=bounces) == pytest.approx(np.exp(-DEPTH), rel=1e-3)


@pytest.mark.parametrize("varies", [False, True])
def test_a_world_tells_what_is_scattered(varies):
    assert fog_under(world(varies, told=True)) == pytest.approx(np.exp(-DEPTH), rel=1e-3)


def test_fog_only_dims_an_image_that_is_hidden_from_it():
    snapshot = fog_alone()
    sky = image_world(snapshot)
    assert fog_under(sky, snapshot) == pytest.approx(1.0, rel=0.015)
    assert fog_under(sky | {"visible_volume": False}, snapshot) == pytest.approx(
        np.exp(-DEPTH), rel=1e-3
    )


def test_hidden_from_transmission_is_not_hidden_from_fog():
    hidden = world() | {"visible_transmission": False}
    assert fog_under(hidden) == pytest.approx(1.0, rel=0.015)


CAMERA, SHADOW = 1, 2


@pytest.mark.parametrize("flags", [HIDDEN - CAMERA, SHADOW])
def test_what_is_hidden_from_fog_casts_its_shadow_there(flags):
    """Fog in a sun, in a case that shows itself to light on surfaces alone, of which there are none, or to nothing:
    black.  Without its shadow it is as if it were not there."""

    def picture(case):
        snapshot = s.orthographic((16, 16), samples=64, film_transparent=False, bounces=2)
        black = s.emission(snapshot, (0, 0, 0))
        box(snapshot, (3, 3, 3), (13, 13, 13), filled(snapshot, scatter(DEPTH / 10)))
        box(snapshot, (2, 2, 2), (14, 14, 14), black)
        snapshot["instances"]["flags"] = [SEEN, case]
        sun = {"name": "Sun", "kind": "SUN", "world_from_light": np.eye(4)[None], "energy": 3.0}
        snapshot["lights"] = [sun]
        return s.render(snapshot)["combined"][4:12, 4:12, 0]

    assert not picture(flags).any()
    alone = picture(0)
    assert alone.mean() > 0.01
    assert np.array_equal(picture(flags - SHADOW), alone)
