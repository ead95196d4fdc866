# SPDX-License-Identifier: GPL-3.0-or-later
"""What turns within the shutter in an even world is as bright at each time as if it stood still: its sides are seen that
are turned away at the frame time, from angles that change."""

import numpy as np
import pytest
import snapshots as s
from session_parts import DOWN
from test_bounces import material, mirror, reflecting
from test_bounces_hard_cases import white_world
from test_dense_meshes import ball, turned
from test_subsurface import scattering

SIZE = (24, 20)
CENTER = (12.3, 9.8, 40.0)
OPENS, CLOSES = -0.4, 0.8  # radians: one side is seen before 0 alone, one after
SIDE = 9.0
SAMPLES = 64
CUBE = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def at(turn):
    """Leaning, so that the top is seen as well."""
    return s.translation(*CENTER) @ turned(0.5, turn)


def evenly_lit(bounces):
    snapshot = s.orthographic(SIZE, samples=SAMPLES, light_samples=16, bounces=bounces)
    white_world(snapshot)
    snapshot["options"]["film_transparent"] = True
    return snapshot


def box(surface, turns, bounces, mover="box"):
    """It turns, or the camera about it."""
    snapshot = evenly_lit(bounces)
    corners = np.asarray(CUBE) * SIDE / 2
    knots = np.stack([at(turn) for turn in turns])
    if mover == "camera":
        snapshot["camera"]["world_from_camera"] = np.stack(
            [at(0.0) @ np.linalg.inv(at(turn)) for turn in turns]
        )
        knots = at(0.0)[None]
    s.mesh(snapshot, corners, FACES, surface(snapshot), transforms=knots)
    return s.render(snapshot)["combined"].astype(float)


def diffuse(snapshot):
    return reflecting(snapshot, "Diffuse", 0.8)


def of_cycles_4_5(snapshot, lobe, inputs):
    kind = {"type": f"ShaderNodeBsdf{lobe}", "properties": {"version": 405.0}}
    return material(snapshot, [{**kind, "inputs": inputs}], (0, "BSDF"))


def sheen(snapshot):
    inputs = {"Color": (0.8, 0.8, 0.8, 1.0), "Roughness": 0.4}
    return of_cycles_4_5(snapshot, "Sheen", inputs)


def paint(snapshot):
    inputs = {"Base Color": (0.8, 0.8, 0.8, 1.0), "Roughness": 0.1, "IOR": 1.5}
    return of_cycles_4_5(snapshot, "Principled", inputs)


def wax(snapshot):
    return scattering(snapshot, albedo=(0.8,) * 3, reach=(2.0,) * 3, version=405)


@pytest.mark.parametrize("mover", ["box", "camera"])
@pytest.mark.parametrize("bounces", [0, 2])
@pytest.mark.parametrize("surface", [diffuse, sheen, paint, wax])
def test_a_box_that_turns_is_the_mean_of_boxes_that_stand(surface, bounces, mover):
    """Sides that turn into sight were lit as seen from inside; sheen had its light from where it was gathered."""
    turns = np.linspace(OPENS, CLOSES, 33)
    moving = box(surface, turns, bounces, mover)
    stills = [box(surface, [turn], bounces, mover) for turn in (turns[:-1] + turns[1:]) / 2]
    truth = np.mean(stills, axis=0)
    blocks = [image.reshape(10, 2, 12, 2, 4).mean(axis=(1, 3)) for image in (moving, truth)]
    # Of wax three deviations of the noise of 16 ways a point, .02 over six seeds.
    assert np.abs(blocks[0] - blocks[1]).max() < (0.06 if surface is wax else 0.03)
    assert moving.sum() == pytest.approx(truth.sum(), rel=0.015 if surface is wax else 0.01)
    # Past whose sides a camera sees for a moment, points along their ends are asked too seldom.
    if surface is diffuse and mover == "box":
        covered = moving[..., 3] > 0.05
        assert np.abs(moving[covered, 0] / moving[covered, 3] - 0.8).max() < 0.03


def wax_ball(rings, bounces, places):
    """What its parts of pixels show, in blocks of 4 x 4 of which it covers a fifth, and all of it."""
    snapshot = evenly_lit(bounces)
    white = scattering(snapshot, albedo=(1.0,) * 3, reach=(2.0,) * 3)
    points, faces = ball(rings, 5.0)
    knots = np.stack([s.translation(x, 9.8, 40.0) for x in places])
    s.mesh(snapshot, points, faces, white, transforms=knots)
    seen = s.render(snapshot)["combined"].astype(float)
    blocks = seen.reshape(5, 4, 6, 4, 4).mean(axis=(1, 3))
    there = blocks[blocks[..., 3] > 0.2]
    return there[:, 0] / there[:, 3], seen[..., 0].sum() / seen[..., 3].sum()


@pytest.mark.parametrize("rings", [12, 40])
@pytest.mark.parametrize("bounces", [0, 2])
def test_wax_of_small_faces_that_moves_is_as_bright_as_where_it_stands(rings, bounces):
    """Samples of small faces began to scatter where the ball is at other times: .21 of its light was left for .95."""
    _, still = wax_ball(rings, bounces, [12.0])
    parts, moving = wax_ball(rings, bounces, [9.0, 15.0])
    assert moving == pytest.approx(still, rel=0.01)
    assert np.abs(parts / still - 1.0).max() < 0.05


def lamp_in_a_mirror(turns):
    """Mean radiance of a card that mirrors a small square lamp a hundred metres before it, which the picture does not hold
    where the card faces the eye."""
    snapshot = s.orthographic(SIZE, samples=256, light_samples=16)
    lamp = {"name": "Lamp", "kind": "AREA", "shape": "SQUARE", "size": (2.0, 2.0), "energy": 1e3}
    lamp["world_from_light"] = (s.translation(42.0, 9.3, -60.0) @ DOWN)[None]
    snapshot["lights"] = [lamp]
    knots = [s.translation(*CENTER) @ turned(0.0, turn) for turn in turns]
    corners = s.rectangle(-40, -40, 40, 40, 0.0)
    s.quad(snapshot, corners, mirror(snapshot), transforms=np.stack(knots))
    return s.render(snapshot)["combined"][..., 0].mean()


def test_a_mirror_that_turns_shows_the_lamp_as_long_as_it_does():
    """For a part of the shutter, to a few micropolygons at a time: none that was asked had seen it."""
    turns = np.linspace(-0.12, 0.12, 33)
    stills = np.linspace(-0.12, 0.12, 257)
    truth = np.mean([lamp_in_a_mirror([turn]) for turn in (stills[:-1] + stills[1:]) / 2])
    assert lamp_in_a_mirror(turns) == pytest.approx(truth, rel=0.05)


def test_wax_that_stands_takes_the_light_of_all_the_shutter():
    """Of small faces, in a world that a card hides from it for half of the time: its samples see nothing that moves."""

    def shown(places):
        snapshot = evenly_lit(0)
        points, faces = ball(40, 5.0)
        s.mesh(snapshot, points, faces, wax(snapshot), transforms=s.translation(*CENTER)[None])
        card = s.rectangle(-60, -60, 60, 60, 0.0)
        knots = np.stack([s.translation(12.0, -20.0, 40.0) @ turned(np.pi / 2, 0.0)] * 2)
        knots[:, 0, 3] = places
        s.quad(snapshot, card, s.emission(snapshot, (0.0, 0.0, 0.0)), transforms=knots)
        return s.render(snapshot)["combined"][..., 0].mean()

    mean = np.mean([shown((x, x)) for x in np.linspace(-148.0, 148.0, 38)])
    assert shown((-150.0, 150.0)) == pytest.approx(mean, rel=0.02)
