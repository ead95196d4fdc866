# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows of what is flattened, mirrored or turned through nothing within the shutter: rays go into its space by
an inverse that is not there at that time."""

import numpy as np
import pytest
import snapshots as s

HALF = 12.0  # of the caster's side, pixels
CASTS_SHADOW, VISIBLE = 2, 3


def lit_floor(matrices):
    """Light on the pixels of a floor, of what it would be without a caster above its middle, which has these
    transforms over the shutter."""

    def render(flags):
        snapshot = s.orthographic((32, 32), executor="SIMD", samples=16, light_samples=256)
        nodes = [{"type": "ShaderNodeBsdfDiffuse", "inputs": {"Color": (0.8, 0.8, 0.8, 1)}}]
        snapshot["materials"].append({"name": "Matte", "nodes": nodes, "surface": (0, "BSDF")})
        s.quad(snapshot, s.rectangle(0, 0, 32, 32, 20.0), 0)
        transforms = [s.translation(16, 16, 10) for _ in matrices]
        for transform, matrix in zip(transforms, matrices):
            transform[:3, :3] = matrix
        s.quad(snapshot, s.rectangle(-HALF, -HALF, HALF, HALF, 0.0), 0, transforms=transforms)
        snapshot["instances"]["flags"] = [VISIBLE, flags]
        down = np.diag([1.0, -1.0, -1.0, 1.0])
        snapshot["lights"] = [
            {"name": "Sun", "kind": "SUN", "world_from_light": down[None], "energy": 3.0}
        ]
        return s.render(snapshot)["combined"][..., 0]

    return render(CASTS_SHADOW) / render(0)


FROM_MIDDLE = np.abs(np.arange(32) - 15.5)
# The mean of 256 stratified times is right to one of them; light is interpolated between points a pixel apart.
TOLERANCE = 1 / 256 + 1 / 24


@pytest.mark.parametrize("scales", [(0, 0, 1), (1, 0, 0), (-1, 1), (0, 1, 0, 1), (1e-30, 1e-25, 1)])
def test_what_is_flat_for_a_while_casts_its_shadow(scales):
    """It is flat in the direction in which it is scaled."""
    light = lit_floor([np.diag([1.0, 1.0, scale]) for scale in scales])
    inside = np.maximum(FROM_MIDDLE[:, None], FROM_MIDDLE[None]) < HALF - 1.0
    assert np.abs(light[inside]).max() == 0.0
    assert light[0, 0] == 1.0


@pytest.mark.parametrize("axes", [(0,), (0, 1)], ids=["mirrored", "turned by a half"])
def test_what_shrinks_to_nothing_and_grows_again(axes):
    """Between two knots on a straight way: a place is dark while the caster is wider than it is far."""
    end = np.eye(3)
    for axis in axes:
        end[axis, axis] = -1.0
    light = lit_floor([np.eye(3), end])
    far = np.where(FROM_MIDDLE < HALF, FROM_MIDDLE / HALF, 1.0)
    expected = np.maximum(far[:, None], far[None]) if len(axes) > 1 else np.tile(far, (32, 1))
    inside = np.maximum(FROM_MIDDLE[:, None], FROM_MIDDLE[None]) < HALF - 1.0
    assert light[inside] == pytest.approx(expected[inside], abs=TOLERANCE)


@pytest.mark.parametrize("scale", [0.0, 1e-30, 1e-13])
def test_what_has_no_size_casts_none(scale):
    assert (lit_floor([np.eye(3) * scale]) == 1.0).all()
