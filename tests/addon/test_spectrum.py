# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of black bodies against published chromaticities."""

import numpy as np
import pytest
from export.shading.observer import WAVELENGTHS, xyz
from export.shading.spectrum import blackbody, monochromatic

# Of linear Rec. 709, D65 (ITU-R BT.709).
XYZ_FROM_RGB = np.array(
    [
        [0.4123908, 0.3575843, 0.1804808],
        [0.2126390, 0.7151687, 0.0721923],
        [0.0193308, 0.1191948, 0.9505322],
    ]
)


# CIE illuminant A is a black body of 2856 K (CIE 15); the others are of the Planckian locus.
@pytest.mark.parametrize(
    "temperature, x, y",
    [(2856.0, 0.44757, 0.40745), (4000.0, 0.3805, 0.3768), (6500.0, 0.3135, 0.3237)],
)
def test_black_bodies_have_their_published_chromaticity(temperature, x, y):
    seen = XYZ_FROM_RGB @ blackbody(temperature)
    # As many digits as are published.
    assert seen[:2] / seen.sum() == pytest.approx([x, y], abs=3e-4)
    assert seen[1] == pytest.approx(1.0, abs=0.001)


def test_even_light_is_seen_as_white():
    """The functions enclose the same area (CIE 15: 106.86 nm each)."""
    areas = 5.0 * xyz(WAVELENGTHS).sum(axis=1)
    assert areas == pytest.approx([106.86] * 3, rel=1e-4)


def test_beyond_the_ends_colors_stay():
    assert blackbody(1.0) == blackbody(800.0)
    assert blackbody(1e9) == blackbody(12000.0)
    assert min(blackbody(800.0)) < 0.0  # beyond what a screen shows


def test_monochromatic_light_is_red_green_blue():
    assert [int(np.argmax(monochromatic(x))) for x in (620.0, 530.0, 450.0)] == [0, 1, 2]
    assert monochromatic(300.0) == monochromatic(800.0) == (0.0, 0.0, 0.0)
