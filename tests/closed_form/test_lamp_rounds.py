# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps light grids by a quarter of their samples, and by the rest where that would be seen."""

import numpy as np
import pytest
import snapshots as s
from session_parts import matte
from test_small_faces import area_lamp

CORNERS = {"samples": 64, "shading_threshold": 1000}  # none of samples that are shaded by themselves
LAMP = ((24, 16, -40), (0, 0, 1), 8.0)
SHADOW = s.rectangle(20, 12, 28, 20, -5.0)  # behind the eye


def wall(lamps, *blockers, light_samples=16, **options):
    """48 x 32 pixels of a white wall: radiance, light samples a point and lamp."""
    options = {"executor": "SIMD", "light_samples": light_samples, **CORNERS, **options}
    snapshot = s.orthographic((48, 32), **options)
    s.quad(snapshot, s.rectangle(0, 0, 48, 32, 20.0), matte(snapshot, (1.0, 1.0, 1.0)))
    for blocker in blockers:
        s.quad(snapshot, blocker, 0)
    snapshot["lights"] = [area_lamp(*lamp) for lamp in lamps]
    result = s.render(snapshot)
    counted = result["statistics"]
    each = counted["rays_shadow"] / counted["points_shaded"] / len(lamps)
    return result, each


def test_a_quarter_tells_light_that_nothing_hides():
    exact, _ = wall([LAMP], light_samples=4096)
    result, each = wall([LAMP])
    assert each == pytest.approx(4, rel=0.01)
    # .0025 of what is displayed, its square root, are .5 % of white.
    assert np.abs(result["combined"] / exact["combined"] - 1)[..., :3].max() < 0.01


def test_a_penumbra_has_all():
    """Of these grids.  Half as many light samples have 1.7 times the noise, a quarter three times."""
    wide = ((24, 16, -40), (0, 0, 1), 60.0)
    exact = wall([wide], SHADOW, light_samples=4096)[0]["combined"][..., 0]
    light, each = wall([wide], SHADOW)
    half, _ = wall([wide], SHADOW, light_samples=8)
    assert each > 15
    noise = [np.std(result["combined"][..., 0] - exact) for result in (light, half)]
    assert noise[0] < 0.7 * noise[1]


def test_grids_without_a_penumbra_do_not_pay_for_those_with_one():
    """A shadow a few pixels wide in a corner of the wall."""
    small = ((24, 16, -40), (0, 0, 1), 2.0)
    _, each = wall([small], s.rectangle(12, 8, 14, 10, -5.0), grid_size=64)
    assert 4 < each < 8


def test_of_many_lamps_the_noisy_ones_go_on():
    """One of nine casts a shadow here; beside eight lamps as bright its penumbra is a ninth of the light."""
    around = [((24 + x, 16, -40), (0, 0, 1), 2.0) for x in range(-400, 401, 100)]
    exact = wall(around, SHADOW, light_samples=1024)[0]["combined"]
    result, each = wall(around, SHADOW)
    assert each < 6
    error = np.sqrt(result["combined"]) - np.sqrt(exact)
    assert np.sqrt(np.mean(error**2)) < 0.0025


@pytest.mark.parametrize("size", [1.0, 3.0, 10.0])
def test_rounds_favour_no_light(size):
    """Grids with a little of a penumbra, whose first round may miss it.  The mean of 40 frames, whose own error is the
    limit: five times its standard deviation."""
    lamp = ((24, 16, -40), (0, 0, 1), size)
    blocker = s.rectangle(10, 10, 24, 13, 0.0)
    exact = wall([lamp], blocker, light_samples=4096)[0]["combined"][..., 0].mean()
    means = [wall([lamp], blocker, seed=n)[0]["combined"][..., 0].mean() for n in range(40)]
    assert abs(np.mean(means) - exact) < 5 * np.std(means) / np.sqrt(40) + 1e-5 * exact


def test_passes_are_the_whole_in_either_round():
    lamps = [LAMP, ((24, 16, -40), (0, 0, 1), 60.0)]
    names = ["Diffuse Direct", "Diffuse Color", "Shadow"]
    result, each = wall(lamps, SHADOW, passes=["Combined", *names])
    direct, color, shadow = (result["passes"][name] for name in names)
    assert 8 < each < 15
    combined = result["combined"][..., :3]
    assert np.abs(direct * color - combined).max() < 1e-5 * combined.max()
    unshadowed = wall(lamps)[0]["combined"]
    assert np.abs(shadow[..., 0] * unshadowed[..., 0] - combined[..., 0]).max() < 0.02 * combined.max()
