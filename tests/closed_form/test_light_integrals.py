# SPDX-License-Identifier: GPL-3.0-or-later
"""Light over the shutter and over lamps, against integrals that NumPy takes: highlights that sweep, lamps that blink,
penumbrae."""

import numpy as np
import pytest
import snapshots as s
from test_refined_shading import (
    EDGE,
    EXECUTORS,
    LIT,
    SIZE,
    SUN,
    VISIBLE,
    caster,
    floor,
    moves,
    row,
    stage,
    turned,
)


def blink(snapshot, energies):
    """The sun's energy, linear between equidistant knots; it shines straight all the time."""
    sun = snapshot["lights"][0]
    sun["world_from_light"] = np.repeat(sun["world_from_light"], len(energies), axis=0)
    sun["energy_knots"] = np.float32(energies) * SUN


def energy_until(energies, t):
    """Integral of the linear interpolation from 0 to t."""
    fine = np.linspace(0.0, 1.0, 4001)
    values = np.interp(fine, np.linspace(0.0, 1.0, len(energies)), energies)
    sums = np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2)]) * (fine[1] - fine[0])
    return np.interp(t, fine, sums)


FLASH = [0.0, 0.0, 4.0, 0.0, 0.0]


@pytest.mark.parametrize("executor", EXECUTORS)
def test_a_lamp_that_blinks_lights_by_its_mean(executor):
    snapshot = stage(executor)
    floor(snapshot)
    blink(snapshot, FLASH)
    assert row(snapshot) == pytest.approx(energy_until(FLASH, 1.0), abs=0.01)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_a_lamp_that_blinks_shows_a_moving_shadow_where_it_is_then(executor):
    """The shadow's edge goes from column 12 to 32; each place is lit by what shone before the edge came."""
    snapshot = stage(executor)
    floor(snapshot)
    caster(snapshot, -300, 0.0, **moves(12.0, 32.0))
    blink(snapshot, FLASH)
    inside = np.arange(SIZE[0] * 16) / 16 + 1 / 32
    lit = energy_until(FLASH, np.clip((inside - 12.0) / 20.0, 0.0, 1.0))
    # Of 256 samples a flash of half the shutter is found by half.
    assert row(snapshot) == pytest.approx(lit.reshape(-1, 16).mean(axis=1), abs=2 * EDGE)


def ggx(roughness, angle):
    """f cos of GGX with Smith's height-correlated masking (Heitz 2014), view and light both along z, the normal tilted."""
    alpha2 = roughness**4
    c = np.cos(angle)
    t = c * c * (alpha2 - 1) + 1
    tan2 = np.tan(angle) ** 2
    masking = 1 / (1 + 2 * 0.5 * (np.sqrt(1 + alpha2 * tan2) - 1))
    return alpha2 / (np.pi * t * t) * masking / (4 * c)


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("roughness, half", [(0.3, 0.15), (0.3, 0.6), (0.5, 0.6)])
def test_a_highlight_that_sweeps_is_the_integral_of_its_lobe(executor, roughness, half):
    """A glossy plane turns by 2 `half` about the direction in which it mirrors the sun."""
    snapshot = stage(executor)
    nodes = [
        {
            "type": "ShaderNodeBsdfGlossy",
            "inputs": {"Color": (1, 1, 1, 1), "Roughness": roughness},
            "properties": {"distribution": "GGX"},
        }
    ]
    snapshot["materials"][0] = {"name": "Metal", "nodes": nodes, "surface": (0, "BSDF")}
    floor(snapshot, transforms=[turned(a) for a in np.linspace(-half, half, 65)])
    angles = np.linspace(-half, half, 20001)
    expected = SUN * ggx(roughness, angles).mean()
    # 256 times of the shutter a pixel, eight columns of twelve rows; a lobe of a tenth of the way.
    seen = row(snapshot)[20:28] * LIT
    assert seen.mean() == pytest.approx(expected, rel=0.01)
    assert seen == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("at", [0.0, 0.5, 1.0])
def test_a_matte_plane_that_turns_has_the_mean_of_its_cosine(executor, at):
    """Wherever in the shutter the frame is at which grids are shaded; a fraction of the threshold turned at once."""
    snapshot = stage(executor, samples=64, shading_threshold=0.1)
    snapshot["options"]["frame_time"] = at
    floor(snapshot, transforms=[turned(a) for a in np.linspace(0.1, 0.4, 33)])
    expected = (np.sin(0.4) - np.sin(0.1)) / 0.3
    assert row(snapshot)[20:28].mean() == pytest.approx(expected, abs=0.004)


@pytest.mark.parametrize("at", [0.0, 1.0])
def test_blades_that_turn_have_the_mean_of_their_cosine(at):
    """Of a dozen micropolygons each, which were asked at one place alone, that tells nothing of chance."""
    snapshot = stage("SIMD", samples=64, shading_threshold=0.1)
    snapshot["options"]["frame_time"] = at
    turns = [turned(a) for a in np.linspace(0.1, 0.4, 33)]
    for x in range(-2, 50, 4):
        for y in range(-2, 26, 4):
            s.quad(snapshot, s.rectangle(x, y, x + 4, y + 4, 20.0), 0, transforms=turns)
            snapshot["instances"]["flags"].append(VISIBLE)
    expected = (np.sin(0.4) - np.sin(0.1)) / 0.3
    assert row(snapshot)[20:28].mean() == pytest.approx(expected, abs=0.004)


LAMP = {"center": (24.0, 8.0), "size": (12.0, 8.0), "z": -30.0}
BLOCKER_Z, FLOOR_Z = 10.0, 20.0


def lamp(snapshot):
    place = np.diag([1.0, -1.0, -1.0, 1.0])
    place[:3, 3] = (*LAMP["center"], LAMP["z"])
    shape = {"shape": "RECTANGLE", "size": LAMP["size"]}
    snapshot["lights"] = [
        {"name": "Area", "kind": "AREA", "world_from_light": place[None], "energy": 9000.0, **shape}
    ]


def seen_part(edge):
    """[columns], the part of the lamp's light that an upright edge leaves, by 16 places in each and 400 x 20 on the lamp."""
    x = np.arange(SIZE[0] * 16) / 16 + 1 / 32
    u = LAMP["center"][0] + LAMP["size"][0] * ((np.arange(400) + 0.5) / 400 - 0.5)
    v = LAMP["size"][1] * ((np.arange(20) + 0.5) / 20 - 0.5)
    high = FLOOR_Z - LAMP["z"]
    distance2 = (x[:, None, None] - u[:, None]) ** 2 + v**2 + high**2
    factor = high**2 / distance2**2
    at_edge = x[:, None] + (u - x[:, None]) * (FLOOR_Z - BLOCKER_Z) / high
    seen = ((at_edge > edge)[:, :, None] * factor).sum((1, 2)) / factor.sum((1, 2))
    return seen.reshape(-1, 16).mean(axis=1)


@pytest.mark.parametrize("executor", EXECUTORS)
def test_the_penumbra_of_a_rectangle_by_a_straight_edge(executor):
    """To a fifth of what one interval of sixteen is, as penumbrae are averaged over the pixels' samples."""

    def columns(blocked):
        snapshot = stage(executor)
        lamp(snapshot)
        floor(snapshot)
        if blocked:
            s.quad(snapshot, s.rectangle(-300, -300, 22.0, 300, BLOCKER_Z), 0)
            snapshot["instances"]["flags"].append(2)
        return row(snapshot)

    assert columns(True) / columns(False) == pytest.approx(seen_part(22.0), abs=EDGE / 5)


ANGLE = 0.4  # of a sun straight above, radians across


def seen_of_sun(edge, x):
    """Part of its disc that a half plane up to `edge` leaves at `x` on the floor, ten below."""
    u = np.clip((x - edge) / (10.0 * np.tan(ANGLE / 2)), -1.0, 1.0)
    return 0.5 + (u * np.sqrt(1.0 - u * u) + np.arcsin(u)) / np.pi


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("ends", [(22.3, 22.3), (20.0, 24.0), (12.0, 32.0)])
def test_the_penumbra_of_a_wide_sun_by_an_edge_that_moves(executor, ends):
    """Standing, by as much as the penumbra is wide, and by five times that: both widen it."""

    def columns(blocked):
        snapshot = stage(executor)
        snapshot["lights"][0]["sun_angle"] = ANGLE
        floor(snapshot)
        if blocked:
            caster(snapshot, -300, 0.0, **moves(*ends))
        return row(snapshot)

    x = np.arange(SIZE[0] * 16) / 16 + 1 / 32
    edges = np.linspace(*ends, 401)
    expected = seen_of_sun(edges[:, None], x).mean(axis=0).reshape(-1, 16).mean(axis=1)
    # Directions of the disc's rim fall on the floor with a cosine of .98.
    assert columns(True) / columns(False) == pytest.approx(expected, abs=EDGE / 4)
