// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace granita {

/// Unpolarised reflectance of a smooth dielectric boundary, exact (Cook and Torrance 1982).
/// `ior` of the far side relative to the near one, > 0.
inline float fresnel_dielectric(float cosine, float ior) {
    const float c = std::abs(cosine);
    const float g2 = ior * ior - 1.0f + c * c;
    if (g2 <= 0.0f) return 1.0f;  // total internal reflection
    const float g = std::sqrt(g2);
    const float a = (g - c) / (g + c);
    const float b = ((g + c) * c - 1.0f) / ((g - c) * c + 1.0f);
    return 0.5f * a * a * (1.0f + b * b);
}

/// Reflectance at normal incidence.
inline float f0_from_ior(float ior) {
    const float ratio = (ior - 1.0f) / (ior + 1.0f);
    return ratio * ratio;
}

}  // namespace granita
