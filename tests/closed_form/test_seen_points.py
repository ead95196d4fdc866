# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that the camera cannot see send fewer ways, and bring as much."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import ALBEDO, diffuse, inside, material, room

SEEN, CAMERA = 59, 1  # an instance's flags: by all rays, by the camera


WIDTH, PERIOD = 0.4, 0.8  # of bars, at .8 of the way to the walls


def barred(ways=(0.0,), light_samples=64, **options):
    """In a furnace of radiance 1 a grey wall behind bars that shine as well."""
    snapshot = inside(1, light_samples=light_samples, **options)
    room(snapshot, s.emission(snapshot))
    s.quad(snapshot, s.rectangle(-0.9, -0.9, 0.9, 0.9, z=0.9), diffuse(snapshot, ALBEDO))
    bars, knots = s.emission(snapshot), [s.translation(x) for x in ways]
    for left in np.arange(-1.6, 1.6, PERIOD):
        corners = s.rectangle(left, -0.85, left + WIDTH, 0.85, z=0.8)
        s.quad(snapshot, corners, bars, transforms=knots)
    return snapshot


def ways_sent(flags, **options):
    """`flags`: of the bars."""
    snapshot = barred()
    snapshot["options"].update(options)
    bars = len(snapshot["instances"]["geometry"]) - 2
    snapshot["instances"]["flags"] = [SEEN, SEEN] + [flags] * bars
    return s.render(snapshot)["statistics"]["rays_bounce"]


def test_what_is_hidden_sends_fewer_ways():
    """Half of the wall; bars that the camera does not see hide nothing."""
    assert ways_sent(SEEN) < 0.7 * ways_sent(SEEN - CAMERA)


def test_beside_what_hides_they_are_few_as_long_as_samples_are():
    """Between the bars the wall is three pixels wide, two of them at an edge: they send a third of
    all ways of many samples, the bars most of the rest."""
    few, many = ways_sent(SEEN, samples=16), ways_sent(SEEN, samples=1024)
    assert few < 0.9 * many
    hides_none = [ways_sent(SEEN - CAMERA, samples=samples) for samples in (16, 1024)]
    assert hides_none[0] == hides_none[1]


def test_what_shows_between_bars_is_as_bright():
    """The furnace is shut: all that comes to the wall sums to 1.  Of 64 light samples edges take
    an eighth: the mean of these 128 pixels was off by 1.5, .3 and 2.3 % with three seeds."""
    seen = s.render(barred(light_samples=512))["combined"][8:24, 8:24, 0]
    wall = seen[seen < 0.7]
    assert wall.size > 60
    assert wall.mean() == pytest.approx(ALBEDO, rel=0.01)


def test_what_bars_pass_over_is_as_bright():
    """By their period within the shutter: they cover half of all."""
    snapshot = barred(ways=(-PERIOD / 2, PERIOD / 2))
    snapshot["options"]["samples"] = 64
    seen = s.render(snapshot)["combined"]
    assert seen[8:24, 8:24, 0].mean() == pytest.approx((1 + ALBEDO) / 2, rel=0.01)


def test_bits_do_not_depend_on_buckets_and_threads():
    whole = s.render(barred())["combined"]
    assert np.array_equal(whole, s.render(barred(bucket_size=16))["combined"])
    assert np.array_equal(whole, s.render(barred(threads=1))["combined"])
    part = s.render(barred(crop=np.int32([4, 8, 20, 24])))["combined"]
    assert np.array_equal(whole[8:24, 4:20], part)


def test_what_shows_through_holes_is_seen():
    """Each way passes the pane, and counts twice there.  Rays from the eye took the first material's opacity for the pane's:
    the wall behind it was left to samples, as what is mostly hidden, at 2.8 times the ways."""

    def sent(has_pane):
        snapshot = inside(1, light_samples=64)
        room(snapshot, s.emission(snapshot))
        s.quad(snapshot, s.rectangle(-0.9, -0.9, 0.9, 0.9, z=0.9), diffuse(snapshot, ALBEDO))
        nodes = [
            {"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (1.0,) * 4}},
            {"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (1.0,) * 4}},
            {"type": "ShaderNodeNewGeometry", "inputs": {}},
            {
                "type": "ShaderNodeMath",
                "properties": {"operation": "LESS_THAN"},  # than 2: all of it
                "inputs": {"Value": ("LINK", 2, "Backfacing"), "Value_001": 2.0},
            },
            {
                "type": "ShaderNodeMixShader",
                "inputs": {
                    "Fac": ("LINK", 3, "Value"),
                    "Shader": ("LINK", 0, "BSDF"),
                    "Shader_001": ("LINK", 1, "BSDF"),
                },
            },
        ]
        pane = material(snapshot, nodes, (4, "Shader"))
        corners = s.rectangle(-0.85, -0.85, 0.85, 0.85, z=0.8)
        if has_pane:
            s.quad(snapshot, corners, pane)
        found = s.render(snapshot)
        assert found["combined"][8:24, 8:24, 0].mean() == pytest.approx(ALBEDO, rel=0.05)
        return found["statistics"]["rays_bounce"]

    assert sent(True) < 2.0 * sent(False)
