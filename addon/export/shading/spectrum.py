# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of light by temperature and by wavelength, in linear Rec. 709.

The observer is the CIE's of 1931, as Cycles' is; radiation is Planck's.
"""

from functools import lru_cache

import numpy as np

from . import observer

TEMPERATURES = (800.0, 12000.0)  # kelvin; beyond them the ends
WAVELENGTHS = (380.0, 780.0)  # nanometres
_RGB_FROM_XYZ = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)
# Cycles' own: keeps monochromatic light within what a screen shows.
_MONOCHROMATIC_SCALE = 1.0 / 2.52


@lru_cache(maxsize=4096)
def blackbody(temperature):
    """(r, g, b) of a black body, of luminance 1; negative where a screen cannot show it.

    Args:
        temperature: kelvin.
    """
    kelvin = min(max(temperature, TEMPERATURES[0]), TEMPERATURES[1])
    wavelength = observer.WAVELENGTHS
    # Planck's law but for a factor; 1.4388e7 nm K is the second radiation constant.
    power = wavelength**-5.0 / np.expm1(1.4388e7 / (wavelength * kelvin))
    xyz = observer.xyz(wavelength) @ power
    return tuple((_RGB_FROM_XYZ @ (xyz / xyz[1])).tolist())


@lru_cache(maxsize=4096)
def monochromatic(wavelength):
    """(r, g, b) of light of one wavelength, nanometres; black beyond WAVELENGTHS.  Negative where a screen cannot
    show it."""
    if not WAVELENGTHS[0] < wavelength < WAVELENGTHS[1]:
        return (0.0, 0.0, 0.0)
    rgb = _RGB_FROM_XYZ @ observer.xyz(np.array([float(wavelength)]))[:, 0]
    return tuple((rgb * _MONOCHROMATIC_SCALE).tolist())
