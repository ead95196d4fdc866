// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

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

/// Schlick's (1 - cos)^5.
inline float schlick_weight(float cosine) {
    const float m = glm::clamp(1.0f - cosine, 0.0f, 1.0f);
    return m * m * m * m * m;
}

// Reflectance of a metal whose colour dips before it turns white at grazing angles: Schlick's less
// dip * cos (1 - cos)^6, where the dip is such that at cos = 1/7, 82 degrees, the tint is left of
// it (Kutz, Hasan and Edmondson 2021, "Novel aspects of the Adobe Standard Material").

inline Vec3f f82_dip(const Vec3f& f0, const Vec3f& tint) {
    constexpr float kCosine = 1.0f / 7.0f, kRest = 6.0f / 7.0f;
    const Vec3f schlick = f0 + (Vec3f(1.0f) - f0) * schlick_weight(kCosine);
    return schlick * (Vec3f(1.0f) - tint) / (kCosine * kRest * schlick_weight(kCosine));
}

/// Dark colours dip below 0 before 82 degrees.
inline Vec3f fresnel_f82(const Vec3f& f0, const Vec3f& dip, float cosine) {
    const float weight = schlick_weight(cosine);
    const Vec3f schlick = f0 + (Vec3f(1.0f) - f0) * weight;
    const float rest = glm::clamp(1.0f - cosine, 0.0f, 1.0f);
    return glm::clamp(schlick - dip * (cosine * rest * weight), Vec3f(0.0f), Vec3f(1.0f));
}

/// Its cosine-weighted mean, where it is not clamped: of (1 - c)^5 it is 1/21, of c (1 - c)^6
/// 1/126.
inline Vec3f f82_mean(const Vec3f& f0, const Vec3f& dip) {
    return f0 + (Vec3f(1.0f) - f0) * (1.0f / 21.0f) - dip * (1.0f / 126.0f);
}

}  // namespace granita
