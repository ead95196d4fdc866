# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour spaces of Blender's own configurations that are a curve and a matrix, and what the Academy's call the usual
ones, for a Blender (3.4 to 4.4) that has no PyOpenColorIO to ask."""

import numpy as np

# To linear Rec. 709.  From the primaries and white points of SMPTE RP 431-2 (white D65), ITU-R BT.2020 and SMPTE ST
# 2065-1, the last adapted from D60 to D65 after Bradford.
_P3 = [
    [1.2249402, -0.2249402, 0.0],
    [-0.0420570, 1.0420570, 0.0],
    [-0.0196376, -0.0786360, 1.0982736],
]
_REC2020 = [
    [1.6604910, -0.5876411, -0.0728499],
    [-0.1245505, 1.1328999, -0.0083494],
    [-0.0181508, -0.1005789, 1.1187297],
]
_AP1 = [
    [1.7050510, -0.6217921, -0.0832589],
    [-0.1302564, 1.1408047, -0.0105483],
    [-0.0240034, -0.1289690, 1.1529723],
]
_AP0 = [
    [2.5216862, -1.1341310, -0.3875552],
    [-0.2764799, 1.3727191, -0.0962392],
    [-0.0153781, -0.1529753, 1.1683534],
]
_XYZ = [
    [3.2409699, -1.5373832, -0.4986108],
    [-0.9692436, 1.8759675, 0.0415551],
    [0.0556301, -0.2039770, 1.0569715],
]
# With the adaptation from illuminant E, and the gamut, that Blender's configuration states.
_XYZ_E = [
    [3.1467518, -1.6663891, -0.4802035],
    [-0.9955120, 1.9557183, 0.0397706],
    [0.0635826, -0.2145451, 1.1507225],
]
_E_GAMUT = [
    [1.9072483, -0.6929665, -0.2142818],
    [-0.1624979, 1.3766553, -0.2141574],
    [-0.1275930, -0.2352385, 1.3628315],
]


def _gamma24(x):
    return np.maximum(x, 0.0) ** 2.4


def _filmic_log(x):
    """Middle grey lies 10 of its 16.5 stops above black."""
    return np.exp2(x * 16.5 - 12.473931188)


# name -> (curve: "DATA", "LINEAR", "SRGB" or a function; to linear Rec. 709, None = is)
_SPACES = {
    "Raw": ("DATA", None),
    "Utility - Raw": ("DATA", None),
    "Linear": ("LINEAR", None),
    "Linear Rec.709": ("LINEAR", None),
    "sRGB": ("SRGB", None),
    "Rec.1886": (_gamma24, None),
    "Filmic Log": (_filmic_log, None),
    "Display P3": ("SRGB", _P3),
    "Linear DCI-P3 D65": ("LINEAR", _P3),
    "Rec.2020": (_gamma24, _REC2020),
    "Linear Rec.2020": ("LINEAR", _REC2020),
    "ACEScg": ("LINEAR", _AP1),
    "Linear ACEScg": ("LINEAR", _AP1),
    "ACES2065-1": ("LINEAR", _AP0),
    "Linear ACES": ("LINEAR", _AP0),
    "XYZ": ("LINEAR", _XYZ),
    "Linear CIE-XYZ D65": ("LINEAR", _XYZ),
    "Linear CIE-XYZ E": ("LINEAR", _XYZ_E),
    "Linear FilmLight E-Gamut": ("LINEAR", _E_GAMUT),
    # ACES 1.0 to 1.2
    "Utility - Linear - sRGB": ("LINEAR", None),
    "Utility - Linear - Rec.709": ("LINEAR", None),
    "Utility - sRGB - Texture": ("SRGB", None),
    "ACES - ACEScg": ("LINEAR", _AP1),
    "ACES - ACES2065-1": ("LINEAR", _AP0),
    # since 1.3
    "Linear Rec.709 (sRGB)": ("LINEAR", None),
    "Linear P3-D65": ("LINEAR", _P3),
    "sRGB - Texture": ("SRGB", None),
    "sRGB Encoded P3-D65 - Texture": ("SRGB", _P3),
    "sRGB Encoded Rec.709 (sRGB)": ("SRGB", None),
}


def blenders_color_space(name):
    """(curve, float64 [3,3] to linear Rec. 709); None for other names, and for pictures of a view transform (Filmic
    sRGB, AgX).  The curve is "DATA" (no colours), "LINEAR", "SRGB" or a function of arrays."""
    found = _SPACES.get(name)
    return found and (found[0], np.eye(3) if found[1] is None else np.array(found[1]))
