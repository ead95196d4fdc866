// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/single_scattering.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/observer.h"
#include "math/sampling.h"

namespace granita {
namespace {

constexpr float kEarthRadius = 6360e3f, kAirRadius = 6420e3f;
constexpr float kAirScale = 8e3f, kDustScale = 1.2e3f;      ///< heights of 1 / e of the density
constexpr float kDustScattering = 2e-5f;                    ///< 1 / m
constexpr float kDustExtinction = 1.11f * kDustScattering;  ///< a tenth is absorbed
constexpr float kDustForward = 0.76f;                       ///< mean cosine
constexpr float kOzoneHeight = 25e3f, kOzoneHalfWidth = 15e3f;
constexpr int kSteps = 32;

constexpr std::size_t kWavelengths = 21;  ///< from 380 to 780 nm: every other of the observer's
constexpr float kWavelengthStep = 20.0f;  ///< nm
using Spectrum = std::array<float, kWavelengths>;

/// Of the sun above the air, W / (m^2 nm): Planck's at 5778 K.
constexpr Spectrum kIrradiance{
    1.4575683f, 1.5659631f, 1.6514845f, 1.7149624f, 1.7579798f, 1.7825641f, 1.7909511f,
    1.7854155f, 1.7681555f, 1.7412207f, 1.7064713f, 1.6655609f, 1.6199344f, 1.5708360f,
    1.5193234f, 1.4662849f, 1.4124585f, 1.3584496f, 1.3047491f, 1.2517496f, 1.1997600f};
/// 1 / m at sea level.
constexpr Spectrum kAirScattering{
    5.4248201e-5f, 4.4185499e-5f, 3.6351519e-5f, 3.0179290e-5f, 2.5263202e-5f, 2.1308593e-5f,
    1.8098380e-5f, 1.5470571e-5f, 1.3302850e-5f, 1.1501848e-5f, 9.9955743e-6f, 8.7279997e-6f,
    7.6551370e-6f, 6.7421720e-6f, 5.9613413e-6f, 5.2903460e-6f, 4.7111569e-6f, 4.2091048e-6f,
    3.7721838e-6f, 3.3905126e-6f, 3.0559153e-6f};
/// 1 / m where the layer is densest: cross sections times 300 Dobson units over 15 km.
constexpr Spectrum kOzoneAbsorption{
    3.2512685e-9f, 5.8539537e-9f, 1.9771912e-8f, 7.3095688e-8f, 2.0084562e-7f, 4.0383959e-7f,
    6.3551336e-7f, 9.6707041e-7f, 1.5479740e-6f, 2.0903865e-6f, 2.4612806e-6f, 2.7355130e-6f,
    2.1512586e-6f, 1.5905184e-6f, 1.1235620e-6f, 7.3527551e-7f, 4.6450130e-7f, 3.3096080e-7f,
    2.2512612e-7f, 1.4879129e-7f, 1.6828623e-7f};
/// Gauss-Laguerre nodes and weights of eight points, the weights times exp(node), both by 25: the
/// last node is within the air.
constexpr std::array<float, 8> kNodes{0.006811185f, 0.03614807f, 0.09004347f, 0.1706680f,
                                      0.2818362f,   0.4303406f,  0.6296271f,  0.9145253f};
constexpr std::array<float, 8> kWeights{0.01750894f, 0.04135477f, 0.06678839f, 0.09507699f,
                                        0.1283416f,  0.1707430f,  0.2327233f,  0.3562490f};

Vec3f xyz_of(const Spectrum& spectrum) {
    Vec3f xyz(0.0f);
    for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < kWavelengths; ++i)
            xyz[c] += kObserver[static_cast<std::size_t>(c)][2 * i] * spectrum[i];
    return kWavelengthStep * xyz;
}

/// Of air, dust and ozone, relative to that at sea level.
Vec3f density_at(float height) {
    return {std::exp(-height / kAirScale), std::exp(-height / kDustScale),
            std::max(0.0f, 1.0f - std::abs(height - kOzoneHeight) / kOzoneHalfWidth)};
}

float air_phase(float cosine) {
    return 3.0f / (16.0f * kPi) * (1.0f + cosine * cosine);
}

/// Cornette and Shanks 1992.
float dust_phase(float cosine) {
    constexpr float g = kDustForward;
    return 3.0f / (8.0f * kPi) * (1.0f - g * g) * (1.0f + cosine * cosine) /
           ((2.0f + g * g) * std::pow(1.0f + g * g - 2.0f * g * cosine, 1.5f));
}

bool meets_earth(const Vec3f& p, const Vec3f& direction) {
    if (direction.z >= 0.0f) return false;
    const float along = glm::dot(direction, p);
    return along * along >= glm::dot(p, p) - kEarthRadius * kEarthRadius;
}

/// To the end of the air.
float distance_out(const Vec3f& p, const Vec3f& direction) {
    const float along = glm::dot(direction, p);
    return -along + std::sqrt(along * along - (glm::dot(p, p) - kAirRadius * kAirRadius));
}

/// Densities summed up along a ray to the end of the air.
Vec3f depth_along(const Vec3f& p, const Vec3f& direction) {
    const float length = distance_out(p, direction);
    Vec3f sum(0.0f);
    for (std::size_t i = 0; i < kNodes.size(); ++i)
        sum += kWeights[i] *
               density_at(glm::length(p + kNodes[i] * length * direction) - kEarthRadius);
    return length * sum;
}

Vec3f towards(float elevation) {
    return {std::cos(elevation), 0.0f, std::sin(elevation)};
}

Vec3f viewer(float altitude) {
    return {0.0f, 0.0f, kEarthRadius + std::clamp(altitude, 1.0f, 59999.0f)};
}

}  // namespace

Vec3f SingleScattering::sky(const Vec3f& direction) const {
    const Vec3f to_sun = towards(m_air.sun_elevation);
    const Vec3f densities(m_air.air, m_air.dust, m_air.ozone);
    const float cosine = glm::dot(direction, to_sun);
    const float by_air = air_phase(cosine), by_dust = dust_phase(cosine) * kDustScattering;
    const Vec3f start = viewer(m_air.altitude);
    const float step = distance_out(start, direction) / kSteps;
    Vec3f depth(0.0f);
    Spectrum spectrum{};
    for (int i = 0; i < kSteps; ++i) {
        const Vec3f p = start + (static_cast<float>(i) + 0.5f) * step * direction;
        const Vec3f density = densities * density_at(glm::length(p) - kEarthRadius);
        depth += step * density;
        if (meets_earth(p, to_sun)) continue;
        const Vec3f all = depth + densities * depth_along(p, to_sun);
        for (std::size_t k = 0; k < kWavelengths; ++k) {
            const float left = std::exp(-(all.x * kAirScattering[k] + all.y * kDustExtinction +
                                          all.z * kOzoneAbsorption[k]));
            spectrum[k] += left * kIrradiance[k] * step *
                           (by_air * density.x * kAirScattering[k] + by_dust * density.y);
        }
    }
    return xyz_of(spectrum);
}

Vec3f SingleScattering::sun(const Atmosphere& air, float elevation, float angular_diameter) {
    const float solid_angle = 2.0f * kPi * (1.0f - std::cos(0.5f * angular_diameter));
    const Vec3f depth = depth_along(viewer(air.altitude), towards(elevation));
    Spectrum spectrum;
    // Ozone is not taken from it, as in Blender.
    for (std::size_t k = 0; k < kWavelengths; ++k)
        spectrum[k] = kIrradiance[k] / solid_angle *
                      std::exp(-(depth.x * air.air * kAirScattering[k] +
                                 depth.y * air.dust * kDustExtinction));
    return xyz_of(spectrum);
}

}  // namespace granita
