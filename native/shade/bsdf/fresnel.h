// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// Fresnel's reflectance by a cosine c and g, the root of ior^2 - 1 + c^2 (Cook and Torrance 1982).
template <class T>
T fresnel_of(const T& c, const T& g) {
    const T a = (g - c) / (g + c);
    const T b = ((g + c) * c - 1.0f) / ((g - c) * c + 1.0f);
    return 0.5f * a * a * (1.0f + b * b);
}

/// Unpolarised reflectance of a smooth dielectric boundary, exact.  `ior` of the far side relative
/// to the near one, > 0.
inline float fresnel_dielectric(float cosine, float ior) {
    const float c = std::abs(cosine);
    const float g2 = ior * ior - 1.0f + c * c;
    if (g2 <= 0.0f) return 1.0f;  // total internal reflection
    return fresnel_of(c, std::sqrt(g2));
}

/// Reflectance at normal incidence.
inline float f0_from_ior(float ior) {
    const float ratio = (ior - 1.0f) / (ior + 1.0f);
    return ratio * ratio;
}

inline float ior_from_f0(float f0) {
    const float root = std::sqrt(glm::clamp(f0, 0.0f, 0.99f));
    return (1.0f + root) / (1.0f - root);
}

/// Schlick's (1 - cos)^5.
inline float schlick_weight(float cosine) {
    const float m = glm::clamp(1.0f - cosine, 0.0f, 1.0f);
    return m * m * m * m * m;
}

// Reflectance of a metal whose colour dips before it turns white at grazing angles: Schlick's less
// dip * cos (1 - cos)^6, where the dip is such that at cos = 1/7, 82 degrees, the tint is left of
// it (Kutz, Hasan and Edmondson 2021, "Novel aspects of the Adobe Standard Material").

constexpr float kF82Cosine = 1.0f / 7.0f;

/// Schlick's reflectance at 82 degrees.
inline Vec3f f82_schlick(const Vec3f& f0) {
    return f0 + (Vec3f(1.0f) - f0) * schlick_weight(kF82Cosine);
}
/// `missing`: of that.
inline Vec3f f82_dip_for(const Vec3f& missing) {
    return missing / (kF82Cosine * (1.0f - kF82Cosine) * schlick_weight(kF82Cosine));
}
inline Vec3f f82_dip(const Vec3f& f0, const Vec3f& tint) {
    return f82_dip_for(f82_schlick(f0) * (Vec3f(1.0f) - tint));
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

/// Unpolarised reflectance of a metal of complex index n + i k, nearly exact: where n^2 + k^2 is
/// far above 1.
inline Vec3f fresnel_conductor(float cosine, const Vec3f& n, const Vec3f& k) {
    const Vec3f c2(cosine * cosine), size2 = n * n + k * k, cross = 2.0f * cosine * n;
    const Vec3f one(1.0f), parallel = size2 * c2 + one, across = size2 + c2;
    return 0.5f * ((parallel - cross) / (parallel + cross) + (across - cross) / (across + cross));
}

/// Its cosine-weighted mean, by that of the F82 curve through its ends and 82 degrees.
inline Vec3f conductor_mean(const Vec3f& n, const Vec3f& k) {
    const Vec3f f0 = fresnel_conductor(1.0f, n, k);
    const Vec3f missing = f82_schlick(f0) - fresnel_conductor(kF82Cosine, n, k);
    return glm::clamp(f82_mean(f0, f82_dip_for(missing)), Vec3f(0.0f), Vec3f(1.0f));
}

}  // namespace granita
