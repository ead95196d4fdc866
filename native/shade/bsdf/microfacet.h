// SPDX-License-Identifier: GPL-3.0-or-later
// Microfacet distributions with Smith's height-correlated masking, isotropic, in the frame of the
// lobe's normal (Walter et al. 2007; Heitz 2014).
#pragma once

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "math/vec.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// Smith's Lambda of GGX; cos in (0, 1].
inline float ggx_lambda(float alpha, float cos_v) {
    const float tan2 = std::max(0.0f, 1.0f / (cos_v * cos_v) - 1.0f);
    return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

/// Smith's Lambda of Beckmann, rational fit of Walter et al. 2007.
inline float beckmann_lambda(float alpha, float cos_v) {
    const float tan2 = std::max(0.0f, 1.0f / (cos_v * cos_v) - 1.0f);
    const float squared = alpha * alpha * tan2;
    if (squared < 0.39f) return 0.0f;  // 1 / 1.6^2: the fit's own limit
    const float a = 1.0f / std::sqrt(squared);
    return ((0.396f * a - 1.259f) * a + 1.0f) / ((2.181f * a + 3.535f) * a);
}

/// `sin2` is the squared sine between half vector and normal: given apart because 1 - cos^2 loses
/// all bits on nearly sharp lobes.
inline float ggx_density(float alpha, float sin2) {
    const float alpha2 = alpha * alpha;
    const float t = sin2 + alpha2 * std::max(0.0f, 1.0f - sin2);
    return alpha2 / (kPi * t * t);
}

inline float beckmann_density(float alpha, float sin2) {
    const float alpha2 = alpha * alpha;
    const float cos2 = std::max(1e-12f, 1.0f - sin2);
    return std::exp(-sin2 / (cos2 * alpha2)) / (kPi * alpha2 * cos2 * cos2);
}

/// Burley 2012, appendix B.2; a lobe of alpha 1 is even.
inline float gtr1_density(float alpha, float sin2) {
    if (alpha >= 1.0f) return kInversePi;
    const float alpha2 = alpha * alpha;
    const float t = sin2 + alpha2 * std::max(0.0f, 1.0f - sin2);
    return (alpha2 - 1.0f) / (kPi * std::log(alpha2) * t);
}

/// Half vector with the density of visible normals, D G1 cos(h, wi) / cos(wi) (Heitz 2018).
inline Vec3f sample_ggx_visible(const Vec3f& wi, const Vec2f& alpha, const Vec2f& u) {
    const Vec3f stretched = glm::normalize(Vec3f(alpha.x * wi.x, alpha.y * wi.y, wi.z));
    const Basis frame(stretched);
    // Basis's x axis need not lie in the horizontal plane; the cut of the projected disc does.
    const float length2 = stretched.x * stretched.x + stretched.y * stretched.y;
    const Vec3f t1 =
        length2 > 1e-14f ? Vec3f(-stretched.y, stretched.x, 0.0f) / std::sqrt(length2) : frame.x;
    const Vec3f t2 = glm::cross(stretched, t1);
    Vec2f d = sample_disc(u);
    const float s = 0.5f * (1.0f + stretched.z);
    d.y = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - d.x * d.x)) + s * d.y;
    const float z = std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y));
    const Vec3f h = d.x * t1 + d.y * t2 + z * stretched;
    return glm::normalize(Vec3f(alpha.x * h.x, alpha.y * h.y, std::max(0.0f, h.z)));
}
inline Vec3f sample_ggx_visible(const Vec3f& wi, float alpha, const Vec2f& u) {
    return sample_ggx_visible(wi, Vec2f(alpha), u);
}

/// Half vector with the density D cos(h).
inline Vec3f sample_gtr1(float alpha, const Vec2f& u) {
    const float alpha2 = alpha * alpha;
    const float sin2 =
        alpha < 1.0f ? (std::pow(alpha2, 1.0f - u.x) - alpha2) / (1.0f - alpha2) : u.x;
    const float sin_h = std::sqrt(std::clamp(sin2, 0.0f, 1.0f));
    const float phi = 2.0f * kPi * u.y;
    return {sin_h * std::cos(phi), sin_h * std::sin(phi), std::sqrt(1.0f - sin_h * sin_h)};
}

/// Half vector with the density D cos(h).
inline Vec3f sample_beckmann(float alpha, const Vec2f& u) {
    const float tan2 = -alpha * alpha * std::log(1.0f - u.x);
    const float cos_h = 1.0f / std::sqrt(1.0f + tan2);
    const float sin_h = std::sqrt(std::max(0.0f, 1.0f - cos_h * cos_h));
    const float phi = 2.0f * kPi * u.y;
    return {sin_h * std::cos(phi), sin_h * std::sin(phi), cos_h};
}

/// Smith's Lambda.
inline float lambda_of(Distribution distribution, float alpha, float cos_v) {
    if (distribution == Distribution::Beckmann) return beckmann_lambda(alpha, cos_v);
    constexpr float kCoatAlpha = 0.25f;
    return ggx_lambda(distribution == Distribution::Gtr1 ? kCoatAlpha : alpha, cos_v);
}

inline float density_of(Distribution distribution, float alpha, float sin2) {
    if (distribution == Distribution::Beckmann) return beckmann_density(alpha, sin2);
    return distribution == Distribution::Gtr1 ? gtr1_density(alpha, sin2)
                                              : ggx_density(alpha, sin2);
}

/// In the lobe's own frame; `wi` there.
inline Vec3f sample_half_vector(Distribution distribution, float alpha, const Vec3f& wi,
                                const Vec2f& u) {
    if (distribution == Distribution::Beckmann) return sample_beckmann(alpha, u);
    if (distribution == Distribution::Gtr1) return sample_gtr1(alpha, u);
    return sample_ggx_visible(wi, alpha, u);
}

inline float squared_sine(const Vec3f& a, const Vec3f& b) {
    const Vec3f c = glm::cross(a, b);
    return std::min(glm::dot(c, c), 1.0f);
}

// The same of facets whose alpha differs along x and y of the lobe's frame, GGX and Beckmann.

inline float stretched_lambda(Distribution distribution, const Vec2f& alpha, const Vec3f& v) {
    // Along the direction's own azimuth the facets are as rough as its ellipse is wide.
    const float across = v.x * v.x + v.y * v.y;
    if (across <= 0.0f) return 0.0f;
    const float x = alpha.x * v.x, y = alpha.y * v.y;
    return lambda_of(distribution, std::sqrt((x * x + y * y) / across), v.z);
}

inline float stretched_density(Distribution distribution, const Vec2f& alpha, const Vec3f& half) {
    const float x = half.x / alpha.x, y = half.y / alpha.y, area = alpha.x * alpha.y;
    const float z2 = std::max(half.z * half.z, 1e-12f);
    if (distribution == Distribution::Beckmann)
        return std::exp(-(x * x + y * y) / z2) / (kPi * area * z2 * z2);
    const float t = x * x + y * y + z2;
    return 1.0f / (kPi * area * t * t);
}

inline Vec3f sample_stretched(Distribution distribution, const Vec2f& alpha, const Vec3f& wi,
                              const Vec2f& u) {
    if (distribution != Distribution::Beckmann) return sample_ggx_visible(wi, alpha, u);
    const Vec3f h = sample_beckmann(1.0f, u);
    return glm::normalize(Vec3f(alpha.x * h.x, alpha.y * h.y, h.z));
}

}  // namespace granita
