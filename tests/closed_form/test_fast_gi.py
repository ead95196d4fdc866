# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' Fast GI against closed forms.  Replace: after some bounces things near hide the world and send nothing; Add:
white light comes from all around, hidden by what is near."""

import numpy as np
import pytest
import snapshots as s
from test_bounces import ALBEDO, diffuse, material, mirror

HEIGHT = 101.0
FACTOR = 0.7


def pane(snapshot, color):
    """Shows what lies behind it, unbent."""
    nodes = [{"type": "ShaderNodeBsdfTransparent", "inputs": {"Color": (color,) * 3 + (1.0,)}}]
    return material(snapshot, nodes, (0, "BSDF"))


def below_a_ceiling(floor, ceiling=None, panes=(), **options):
    """A floor that fills the frame, `HEIGHT` below an endless ceiling behind the camera; a world of 1.  `panes`: how far
    below the ceiling, behind the camera too, and of which colour each."""
    snapshot = s.orthographic(
        (16, 16),
        samples=16,
        light_samples=256,
        clamp_indirect=0.0,
        filter_glossy=0.0,
        **{"bounces": 4, "occlusion_factor": FACTOR, **options},
    )
    s.quad(snapshot, s.rectangle(-1e5, -1e5, 1e5, 1e5, z=HEIGHT - 1.0), floor(snapshot))
    above = ceiling(snapshot) if ceiling else diffuse(snapshot, ALBEDO)
    s.quad(snapshot, s.rectangle(-1e5, -1e5, 1e5, 1e5, z=-1.0), above)
    for below, color in panes:
        s.quad(snapshot, s.rectangle(-1e5, -1e5, 1e5, 1e5, z=below - 1.0), pane(snapshot, color))
    s.constant_world(snapshot, 1.0)
    snapshot["world"]["lights_scene"] = True
    return s.render(snapshot)


@pytest.mark.parametrize("reach", [0.9, 1.5, 3.0])
@pytest.mark.parametrize("bounce", [1, 2, 3])
def test_what_is_near_hides_the_world(bounce, reach):
    """A ray leaves the ceiling out where it is longer than the reach: where its cosine is below 1 / reach, so that the
    world brings 1 / reach^2 of itself.  Bounces before that see nothing but the other plane."""
    rendered = below_a_ceiling(
        lambda snapshot: diffuse(snapshot, ALBEDO),
        occluded_from=bounce,
        occlusion_distance=reach * HEIGHT,
    )
    due = ALBEDO**bounce * FACTOR * min(1.0, reach**-2)
    # Of 256 pixels' 256 samples, shared by neighbours: a part in a hundred is six times their noise.
    assert rendered["combined"][..., 0].mean() == pytest.approx(due, rel=0.01)
    # What hides is not shaded.
    assert (rendered["statistics"]["hits_shaded"] == 0) == (bounce == 1)


def test_a_mirror_does_not_count():
    """It shows the ceiling, which the world lights."""
    rendered = below_a_ceiling(mirror, occluded_from=1, occlusion_distance=1.5 * HEIGHT)
    due = ALBEDO * FACTOR / 1.5**2
    assert rendered["combined"][..., 0].mean() == pytest.approx(due, rel=0.01)


@pytest.mark.parametrize("bounces", [0, 1, 3])
@pytest.mark.parametrize("reach", [0.9, 1.5])
def test_white_light_is_added_at_every_surface(bounces, reach):
    """Planes light each other with as much as reaches the floor."""
    rendered = below_a_ceiling(
        lambda snapshot: diffuse(snapshot, ALBEDO),
        occlusion_added=FACTOR,
        occlusion_distance=reach * HEIGHT,
        bounces=bounces,
    )
    due = FACTOR * min(1.0, reach**-2) * sum(ALBEDO ** (k + 1) for k in range(bounces + 1))
    assert rendered["combined"][..., 0].mean() == pytest.approx(due, rel=0.01)


@pytest.mark.parametrize("reach", [0.9, 1.5])
def test_white_light_is_added_once_however_many_panes_there_are(reach):
    """A pane that lets half of the light through instead of the ceiling, and a clear one below it: both pass on the
    world as well."""
    rendered = below_a_ceiling(
        lambda snapshot: diffuse(snapshot, ALBEDO),
        lambda snapshot: pane(snapshot, 0.5),
        panes=[(0.5, 1.0)],
        occlusion_added=FACTOR,
        occlusion_distance=reach * HEIGHT,
        bounces=1,
    )
    beyond = min(
        1.0, reach**-2
    )  # of the light: what comes from beyond the reach without meeting a pane
    due = ALBEDO * (0.5 + FACTOR * (beyond + 0.5 * (1 - beyond)))
    assert rendered["combined"][..., 0].mean() == pytest.approx(due, rel=0.01)


def test_a_pane_does_not_begin_the_distance_anew():
    rendered = below_a_ceiling(
        lambda snapshot: diffuse(snapshot, ALBEDO),
        panes=[(0.9, 1.0)],
        occluded_from=1,
        occlusion_distance=1.5 * HEIGHT,
    )
    due = ALBEDO * FACTOR / 1.5**2
    assert rendered["combined"][..., 0].mean() == pytest.approx(due, rel=0.01)


def test_nothing_is_left_out_without_it():
    """No ray between endless planes finds the world."""
    rendered = below_a_ceiling(lambda snapshot: diffuse(snapshot, ALBEDO))
    assert np.all(rendered["combined"][..., :3] < 0.002)
