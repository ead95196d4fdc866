# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of light by temperature and by wavelength, in linear Rec. 709.

The observer is the CIE's of 1931 in the closed form of Wyman, Sloan and Shirley (2013, "Simple Analytic
Approximations to the CIE XYZ Color Matching Functions"), within 1 % of the tables; radiation is Planck's.
"""

from functools import lru_cache

import numpy as np

TEMPERATURES = (800.0, 12000.0)  # kelvin; beyond them the ends
WAVELENGTHS = (380.0, 780.0)  # nanometres
_STEP = 5.0
_RGB_FROM_XYZ = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)
# Cycles' own: keeps monochromatic light within what a screen shows.
_MONOCHROMATIC_SCALE = 1.0 / 2.52
# (height, centre, 1 / width below it, 1 / width above it) of lobes, nanometres.
_LOBES = (
    (
        (0.362, 442.0, 0.0624, 0.0374),
        (1.056, 599.8, 0.0264, 0.0323),
        (-0.065, 501.1, 0.0490, 0.0382),
    ),
    ((0.821, 568.8, 0.0213, 0.0247), (0.286, 530.9, 0.0613, 0.0322)),
    ((1.217, 437.0, 0.0845, 0.0278), (0.681, 459.0, 0.0385, 0.0725)),
)


def _xyz(wavelength):
    """float64 [3, n] of wavelengths [n]."""
    rows = []
    for lobes in _LOBES:
        row = np.zeros_like(wavelength)
        for height, centre, below, above in lobes:
            x = (wavelength - centre) * np.where(wavelength < centre, below, above)
            row += height * np.exp(-0.5 * x * x)
        rows.append(row)
    return np.array(rows)


@lru_cache(maxsize=4096)
def blackbody(temperature):
    """(r, g, b) of a black body, of luminance 1; colours that a screen cannot show are cut off at 0.

    Args:
        temperature: kelvin.
    """
    kelvin = min(max(temperature, TEMPERATURES[0]), TEMPERATURES[1])
    wavelength = np.arange(360.0, 830.0, _STEP)
    # Planck's law but for a factor; 1.4388e7 nm K is the second radiation constant.
    power = wavelength**-5.0 / np.expm1(1.4388e7 / (wavelength * kelvin))
    xyz = _xyz(wavelength) @ power
    return tuple(np.maximum(_RGB_FROM_XYZ @ (xyz / xyz[1]), 0.0).tolist())


@lru_cache(maxsize=4096)
def monochromatic(wavelength):
    """(r, g, b) of light of one wavelength, nanometres; black beyond WAVELENGTHS."""
    if not WAVELENGTHS[0] < wavelength < WAVELENGTHS[1]:
        return (0.0, 0.0, 0.0)
    rgb = _RGB_FROM_XYZ @ _xyz(np.array([float(wavelength)]))[:, 0]
    return tuple(np.maximum(rgb * _MONOCHROMATIC_SCALE, 0.0).tolist())
