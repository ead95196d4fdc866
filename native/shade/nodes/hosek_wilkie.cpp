// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/hosek_wilkie.h"

#include <algorithm>
#include <cmath>

#include "math/angle_between.h"
#include "math/normalize_or.h"
#include "math/sampling.h"
#include "shade/nodes/hosek_wilkie_table.h"

namespace granita {
namespace {

/// Radiance to what Cycles shows.
constexpr float kScale = 2.0f * kPi / 683.0f;
/// As for Preetham's, directions end a little above the horizon.
constexpr float kLowest = 0.001f;

constexpr std::size_t kControlPoints = 6, kTurbidities = 10;

/// Bernstein's polynomials of degree 5.
std::array<float, kControlPoints> quintic(float t) {
    constexpr std::array<float, kControlPoints> kBinomial{1, 5, 10, 10, 5, 1};
    std::array<float, kControlPoints> weights{};
    for (std::size_t k = 0; k < kControlPoints; ++k)
        weights[k] = kBinomial[k] * std::pow(1.0f - t, static_cast<float>(kControlPoints - 1 - k)) *
                     std::pow(t, static_cast<float>(k));
    return weights;
}

}  // namespace

// The paper's equations 8 and 9.
float HosekWilkieSky::Distribution::at(float cosine, float gamma) const {
    const float to_sun = std::cos(gamma);
    const float g = shape[8];
    const float forward =
        (1.0f + to_sun * to_sun) / std::pow(1.0f + g * g - 2.0f * g * to_sun, 1.5f);
    return radiance * (1.0f + shape[0] * std::exp(shape[1] / (cosine + 0.01f))) *
           (shape[2] + shape[3] * std::exp(shape[4] * gamma) + shape[5] * to_sun * to_sun +
            shape[6] * forward + shape[7] * std::sqrt(cosine));
}

HosekWilkieSky::HosekWilkieSky(const Vec3f& to_sun, float turbidity, float ground_albedo)
    : m_to_sun(normalize_or(Vec3f(to_sun.x, to_sun.y, std::max(to_sun.z, 0.0f)),
                            Vec3f(0.0f, 1.0f, 0.0f))) {
    const float elevation = std::asin(std::min(m_to_sun.z, 1.0f));
    const auto by_elevation = quintic(std::cbrt(elevation / (0.5f * kPi)));
    const float haze = std::clamp(turbidity, 1.0f, static_cast<float>(kTurbidities)) - 1.0f;
    const auto low = std::min(static_cast<std::size_t>(haze), kTurbidities - 2);
    const float high = haze - static_cast<float>(low);
    for (std::size_t color = 0; color < 3; ++color)
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const std::size_t albedo = corner / 2, step = corner % 2;
            const float weight = (albedo == 1 ? ground_albedo : 1.0f - ground_albedo) *
                                 (step == 1 ? high : 1.0f - high);
            const std::size_t row =
                ((2 * color + albedo) * kTurbidities + low + step) * kControlPoints;
            Distribution& d = m_xyz[color];
            for (std::size_t k = 0; k < kControlPoints; ++k) {
                const float w = weight * by_elevation[k];
                d.radiance += w * kHosekWilkieRadiance[row + k];
                for (std::size_t i = 0; i < d.shape.size(); ++i)
                    d.shape[i] += w * kHosekWilkieShape[(row + k) * d.shape.size() + i];
            }
        }
    for (Distribution& d : m_xyz) d.radiance *= kScale;
}

Vec3f HosekWilkieSky::xyz(const Vec3f& direction) const {
    const float cosine = std::max(direction.z, std::sin(kLowest));
    const float gamma = angle_between(direction, m_to_sun);
    return {m_xyz[0].at(cosine, gamma), m_xyz[1].at(cosine, gamma), m_xyz[2].at(cosine, gamma)};
}

}  // namespace granita
