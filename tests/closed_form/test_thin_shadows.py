# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows thinner than the micropolygons whose corners are to tell of them: wires, and slits in what is dark."""

import numpy as np
import pytest
import snapshots as s
from session_parts import DOWN, matte
from test_dense_meshes import ball
from test_refined_shading import ALBEDO, CASTS_SHADOW, LIT, SUN, VISIBLE

SIZE = 64
EVERY, SLOPE = 7.0, 0.13


def stage(bucket_size=32, **light):
    """A floor under a lamp: the sun along the view if `light` says nothing else."""
    snapshot = s.orthographic((SIZE, SIZE), samples=64, bucket_size=bucket_size)
    matte(snapshot, (ALBEDO,) * 3)
    lamp(snapshot, **{"energy": SUN, **light})
    snapshot["instances"]["flags"] = []
    s.quad(snapshot, s.rectangle(-200, -200, 250, 200, 20.0), 0)
    snapshot["instances"]["flags"].append(VISIBLE)
    return snapshot


def lamp(snapshot, **values):
    snapshot.setdefault("lights", []).append(
        {"name": "Lamp", "kind": "SUN", "world_from_light": DOWN[None], **values}
    )


def bars(snapshot, part, z=10.0, transforms=None):
    """That fill `part` of every seven pixels, askew, and that the lamp alone sees."""
    for x in np.arange(-140.0, 210.0, EVERY):
        corners = [(x - SLOPE * y + w, y, z) for y, w in ((-150, 0), (-150, part * EVERY))]
        corners += [(x - SLOPE * y + w, y, z) for y, w in ((150, part * EVERY), (150, 0))]
        s.quad(snapshot, np.array(corners), 0, transforms=transforms)
        snapshot["instances"]["flags"].append(CASTS_SHADOW)


def seen(snapshot):
    return s.render(snapshot)["combined"][..., 0] / LIT


@pytest.mark.parametrize("width", [0.1, 0.2, 0.4])
@pytest.mark.parametrize("angle", [0.0, 0.005])
def test_wires_cast_all_of_their_shadow(width, angle):
    """Pixels: they were dashes that lacked 41, 31 and 11 %.

    Ten pixels above the floor the sun's disc is .05 wide, half of the thinnest wire's shadow: corners see a part of it.
    """
    snapshot = stage(sun_angle=angle)
    bars(snapshot, width / EVERY)
    bound = 0.07 if angle > 0.4 * width / 10 else 0.04
    assert 1.0 - seen(snapshot).mean() == pytest.approx(width / EVERY, rel=bound)


def test_slits_let_all_of_their_light_through():
    snapshot = stage()
    bars(snapshot, 1.0 - 0.2 / EVERY)
    assert seen(snapshot).mean() == pytest.approx(0.2 / EVERY, rel=0.03)


def test_wires_before_a_lamp_with_a_place():
    """So far off that its wires' shadows are as wide as they; the floor without them says what is lit."""
    far = 2e4
    at = s.translation(SIZE / 2, SIZE / 2, 20.0 - far) @ DOWN
    bulb = {"kind": "POINT", "world_from_light": at[None], "energy": 1e9, "radius": 50.0}
    plain, wired = stage(**bulb), stage(**bulb)
    bars(wired, 0.2 / EVERY)
    lit, shaded = (s.render(snapshot)["combined"][..., 0].mean() for snapshot in (plain, wired))
    assert 1.0 - shaded / lit == pytest.approx(0.2 / EVERY, rel=0.03)


def test_no_bit_depends_on_buckets():
    pictures = []
    for bucket_size in (16, 64):
        snapshot = stage(bucket_size=bucket_size)
        bars(snapshot, 0.2 / EVERY)
        pictures.append(s.render(snapshot)["combined"])
    assert np.array_equal(*pictures)


@pytest.mark.parametrize("moved", [0.0, 3.0])
def test_wires_that_move(moved):
    """Across the view: their shadow lies on other micropolygons at each moment, and is as much."""
    snapshot = stage()
    knots = [s.translation(-moved / 2), s.translation(moved / 2)]
    bars(snapshot, 0.2 / EVERY, transforms=knots)
    assert 1.0 - seen(snapshot).mean() == pytest.approx(0.2 / EVERY, rel=0.05)


def test_shadows_that_nobody_sees_cost_no_samples():
    """Of a lamp that is a thousandth of another, and of wires whose shadow is none."""
    snapshot = stage()
    lamp(snapshot, energy=SUN / 1000)
    snapshot["lights"][0]["casts_shadow"] = False
    bars(snapshot, 0.2 / EVERY)
    assert s.render(snapshot)["statistics"]["points_refined"] == 0


def test_a_floor_in_the_sun_asks_a_few_more_rays():
    """One for every four micropolygons where nothing is found."""
    snapshot = stage()
    s.quad(snapshot, s.rectangle(-9e3, -9e3, -8e3, -8e3, 10.0), 0)
    snapshot["instances"]["flags"].append(CASTS_SHADOW)
    statistics = s.render(snapshot)["statistics"]
    assert statistics["points_refined"] == 0
    assert statistics["rays_shadow"] <= 1.3 * statistics["points_shaded"]


def test_a_thing_that_turns_is_not_shaded_by_samples_for_its_own_shadow():
    """Its surface comes before places where it is at the frame."""
    refined = []
    for casts in (True, False):
        snapshot = stage(sun_angle=0.0)
        snapshot["instances"]["flags"] = [0]  # no floor
        points, faces = ball(40, 14.0)
        knots = []
        for angle in (-0.2, 0.2):
            turn = s.translation(SIZE / 2 + 10 * angle, SIZE / 2, 60.0)
            c, d = np.cos(angle), np.sin(angle)
            turn[:3, :3] = [[c, 0, d], [0, 1, 0], [-d, 0, c]]
            knots.append(turn)
        s.mesh(snapshot, points, faces, 0, knots, smooth=np.ones(len(faces), np.uint8))
        snapshot["instances"]["flags"].append(VISIBLE | CASTS_SHADOW if casts else VISIBLE)
        refined.append(s.render(snapshot)["statistics"]["points_refined"])
    assert refined[0] < 1.2 * refined[1] + 64 * 20


def test_a_penumbra_is_told_by_corners():
    """Of a common sun, four pixels wide beside an edge: single samples of it that differ say nothing."""
    snapshot = stage(sun_angle=0.0092)
    far = s.rectangle(-300.0, -300.0, SIZE / 2, 400.0, 20.0 - 4.0 / 0.0092)
    s.quad(snapshot, far, 0)
    snapshot["instances"]["flags"].append(CASTS_SHADOW)
    statistics = s.render(snapshot)["statistics"]
    assert statistics["points_refined"] < 64 * SIZE * 16
