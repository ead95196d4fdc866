# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices and curves that stand for Blender's own configuration where there is no module to ask."""

import numpy as np
import pytest
from export.shading.blenders_color_spaces import _SPACES, blenders_color_space


@pytest.mark.parametrize("name", [name for name in _SPACES if "XYZ" not in name])
def test_white_is_white(name):
    curve, matrix = blenders_color_space(name)
    assert callable(curve) or curve in ("DATA", "LINEAR", "SRGB")
    assert matrix @ np.ones(3) == pytest.approx(np.ones(3), abs=1e-3)
    if callable(curve) and name != "Filmic Log":
        assert curve(np.ones(1))[0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    "name, white",
    [("XYZ", (0.95047, 1.0, 1.08883)), ("Linear CIE-XYZ E", (1.0, 1.0, 1.0))],
)
def test_white_of_xyz_is_that_of_its_illuminant(name, white):
    assert blenders_color_space(name)[1] @ white == pytest.approx(np.ones(3), abs=1e-3)


def test_curves():
    assert blenders_color_space("Rec.1886")[0](np.array([-1.0, 0.5])) == pytest.approx(
        [0, 0.5**2.4]
    )
    # Middle grey lies 10 of 16.5 stops above black.
    assert blenders_color_space("Filmic Log")[0](np.array([10 / 16.5])) == pytest.approx([0.18])


def test_other_names():
    assert blenders_color_space("AgX Base sRGB") is None
    assert blenders_color_space("nonsense") is None
