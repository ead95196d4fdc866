# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient Occlusion below a ceiling: of the cosine-weighted directions those are closed that reach it within the
distance, 1 - (height / distance)^2 of them."""

import numpy as np
import pytest
import snapshots as s

SIZE = 16
HEIGHT = 20.0


def below_a_ceiling(distance, normal=None, **properties):
    snapshot = s.orthographic((SIZE, SIZE), executor="SIMD", samples=16)
    inputs = {"Distance": distance, "Color": (1.0, 0.5, 0.25, 1.0)}
    if normal is not None:
        inputs["Normal"] = ("LINK", 0, "Vector")
    nodes = [
        {"type": "ShaderNodeCombineXYZ", "inputs": dict(zip("XYZ", normal or (0.0, 0.0, 0.0)))},
        {
            "type": "ShaderNodeAmbientOcclusion",
            "inputs": inputs,
            "properties": {"samples": 16.0, **properties},
        },
        {"type": "ShaderNodeEmission", "inputs": {"Color": ("LINK", 1, "Color"), "Strength": 1.0}},
    ]
    snapshot["materials"].append({"name": "Open", "nodes": nodes, "surface": (2, "Emission")})
    s.quad(snapshot, s.rectangle(0, 0, SIZE, SIZE, 60.0), 0)
    s.quad(snapshot, s.rectangle(-300, -300, 300, 300, 60.0 - HEIGHT), 0)
    snapshot["camera"]["clip"] = (60.0 - HEIGHT / 2, 100.0)  # it is not seen
    return s.render(snapshot)["combined"][..., :3]


@pytest.mark.parametrize("distance", [10.0, 30.0, 60.0])
def test_part_of_the_directions(distance):
    image = below_a_ceiling(distance)
    expected = min(1.0, (HEIGHT / distance) ** 2)
    # 256 directions a point, of which 4 points and more make a pixel: were they random, pixels would be off by less than
    # .016 (one deviation), all of them together by .001; stratified, they are not a third as far off.
    np.testing.assert_allclose(image[..., 0], expected, atol=0.02)
    assert image[..., 0].mean() == pytest.approx(expected, abs=0.001)
    np.testing.assert_allclose(image[..., 1], 0.5 * image[..., 0], rtol=1e-6)


def test_a_normal_is_a_direction():
    leaning = below_a_ceiling(30.0, normal=(0.6, 0.0, -0.8))
    np.testing.assert_array_equal(below_a_ceiling(30.0, normal=(1.8, 0.0, -2.4)), leaning)
    # About a way that leans the ceiling is met by fewer.
    assert leaning[..., 0].mean() > 0.5
    np.testing.assert_array_equal(
        below_a_ceiling(30.0, normal=(0.0, 0.0, 0.0)), below_a_ceiling(30.0)
    )


def test_its_own_other_side_alone():
    np.testing.assert_array_equal(below_a_ceiling(60.0, only_local=1.0)[..., 0], 1.0)
    np.testing.assert_array_equal(below_a_ceiling(60.0, inside=1.0)[..., 0], 1.0)
