# SPDX-License-Identifier: GPL-3.0-or-later
"""Points whose first rays to a lamp agree with those around send no more: what all see is right, what none has seen is
not taken for open."""

import numpy as np
import pytest
import snapshots as s

SIZE = (48, 48)
LAMP_Z, BAR_Z, FLOOR_Z = -60.0, -59.9, 20.0
WIDE = 12.0
LIGHT_SAMPLES = 16


def stage(bar=None, caster=None, **options):
    """Grey picture and shadow rays of a floor, shaded at corners alone, under a square lamp.

    Args:
        bar: part of the lamp's width that is covered just below it, from there to there.
        caster: rectangle (x0, y0, x1, y1) between the lamp and the floor.
    """
    fixed = {"samples": 16, "light_samples": LIGHT_SAMPLES, "shading_threshold": 1000.0}
    snapshot = s.orthographic(SIZE, executor="SIMD", **{**fixed, **options})
    nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (1, 1, 1, 1)}}]
    snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
    place = np.diag([1.0, -1.0, -1.0, 1.0])
    place[:3, 3] = (24.0, 24.0, LAMP_Z)
    shape = {"shape": "SQUARE", "size": (WIDE, WIDE)}
    lamp = {"name": "Area", "kind": "AREA", "world_from_light": place[None], "energy": 30000.0}
    snapshot["lights"] = [{**lamp, **shape}]
    s.quad(snapshot, s.rectangle(-200, -200, 250, 250, FLOOR_Z), 0)
    flags = [1]
    if bar is not None:
        x0, x1 = (24.0 + WIDE * (part - 0.5) for part in bar)
        s.quad(snapshot, s.rectangle(x0, 0, x1, 48, BAR_Z), 0)
        flags.append(2)
    if caster is not None:
        s.quad(snapshot, s.rectangle(*caster, 10.0), 0)
        flags.append(2)
    snapshot["instances"]["flags"] = flags
    result = s.render(snapshot)
    return result["combined"][..., 0], result["statistics"]["rays_shadow"]


@pytest.mark.parametrize("wide", [0.01, 0.02])
@pytest.mark.parametrize("begin", [0.03, 0.31, 0.47, 0.71])
def test_what_covers_little_of_a_lamp_is_seen_by_most(begin, wide):
    """324 rays around a point are all over the lamp together: were they independent, .04 of the points would miss a
    hundredth.  Of a hundred rays .27 did."""
    open_light, _ = stage(light_samples=256)
    covered, _ = stage(bar=(begin, begin + wide))
    assert covered.mean() / open_light.mean() == pytest.approx(1 - wide, abs=0.1 * wide)


@pytest.mark.parametrize("begin", np.arange(16) / 16)
def test_what_covers_a_sixteenth_of_a_lamp_takes_that_of_its_light(begin):
    """Wherever it lies: a point's first four rays leave twelve sixteenths of the lamp's width alone, but those of the
    points around look there.  With the same first four for all the light was 3 to 4 % too bright."""
    open_light, _ = stage(light_samples=256)
    covered, _ = stage(bar=(begin, begin + 1 / 16))
    # The lamp's solid angle is 1 / 45: each sixteenth gives as much to .5 %.
    assert covered.mean() / open_light.mean() == pytest.approx(15 / 16, abs=2e-3)


def test_rays_are_sent_where_shadows_end():
    """A small thing's penumbra covers a tenth of the floor."""
    _, of_open = stage()
    _, of_shadow = stage(caster=(18, 18, 26, 26))
    _, of_penumbra = stage(bar=(0.4, 0.6))
    assert of_open < 0.27 * of_penumbra  # four of sixteen
    assert of_open < of_shadow < 0.7 * of_penumbra


def test_a_penumbra_is_as_with_all_rays():
    """Against 1024 light samples, of which a quarter is 256: noise alone is left, and no step where rays end."""
    exact, _ = stage(caster=(18, 18, 26, 26), light_samples=1024)
    seen, _ = stage(caster=(18, 18, 26, 26))
    assert np.mean(seen) == pytest.approx(np.mean(exact), rel=1e-3)
    rim = (exact > 0.02 * exact.max()) & (exact < 0.98 * exact.max())
    assert np.mean(seen[rim] - exact[rim]) == pytest.approx(0.0, abs=4e-3 * exact.max())
