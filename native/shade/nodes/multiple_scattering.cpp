// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/multiple_scattering.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "math/sampling.h"

namespace granita {
namespace {

constexpr float kEarthRadius = 6371.0f, kThickness = 100.0f;
constexpr float kAirRadius = kEarthRadius + kThickness;
constexpr float kAerosolForward = 0.8f;  ///< mean cosine
constexpr float kGroundAlbedo = 0.3f;
constexpr int kSteps = 64;
constexpr int kCosines = 256, kHeights = 64;

// At 630, 560, 490 and 430 nm.  Cross sections of ozone in m^2 a molecule, of urban aerosol.
const Vec4f kIrradiance(1.679f, 1.828f, 1.986f, 1.307f);  ///< above the air, W / (m^2 nm)
const Vec4f kMolecules(6.605e-3f, 1.067e-2f, 1.842e-2f, 3.156e-2f);  ///< 1 / km at sea level
const Vec4f kOzone(3.472e-25f, 3.914e-25f, 1.349e-25f, 11.03e-27f);
const Vec4f kAerosolAbsorption(2.8722e-24f, 4.6168e-24f, 7.9706e-24f, 1.3578e-23f);
const Vec4f kAerosolScattering(1.5908e-22f, 1.7711e-22f, 2.0942e-22f, 2.4033e-22f);
constexpr float kDobson = 334.5f;
constexpr float kAerosolDensity = 1.3681e20f, kAerosolBackground = 2e6f, kAerosolScale = 0.73f;
/// Fit of what comes from elsewhere in the air.
const Vec4f kScatteredOften = 0.02f * Vec4f(0.217f, 0.347f, 0.594f, 1.0f);

Vec3f xyz_of(const Vec4f& s) {
    return {53.386918f * s.x + 43.904844f * s.y + 1.6137278f * s.z + 20.762669f * s.w,
            22.981338f * s.x + 71.347796f * s.y + 18.422961f * s.z + 2.3614214f * s.w,
            0.10250687f * s.y + 31.742921f * s.z + 110.48010f * s.w};
}

float molecule_phase(float cosine) {
    return 3.0f / (16.0f * kPi) * (1.0f + cosine * cosine);
}

/// Henyey and Greenstein 1941.
float aerosol_phase(float cosine) {
    constexpr float g = kAerosolForward;
    const float base = 1.0f + g * g - 2.0f * g * cosine;
    return (1.0f - g * g) / (4.0f * kPi * base * std::sqrt(base));
}

/// Where a ray first meets a sphere round the earth's centre; negative: nowhere.
float distance_to(const Vec3f& p, const Vec3f& direction, float radius) {
    const float along = glm::dot(p, direction);
    const float outside = glm::dot(p, p) - radius * radius;
    const float root2 = along * along - outside;
    if ((outside > 0.0f && along > 0.0f) || root2 < 0.0f) return -1.0f;
    return outside > 0.0f ? -along - std::sqrt(root2) : -along + std::sqrt(root2);
}

Vec3f towards(float cosine) {
    return {std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
}

float height_of(const Vec3f& p) {
    return std::max(glm::length(p) - kEarthRadius, 0.0f);
}

struct Coefficients {
    Vec4f molecules, aerosol;  ///< scattered, 1 / km
    Vec4f extinction;
};

Coefficients coefficients_at(const Atmosphere& air, float height) {
    const float log_height = std::log(std::max(height, 1e-4f));
    const float above_layer = log_height - 3.22261f;
    const float ozone =
        3.78547397e20f * std::exp(-above_layer * above_layer * 5.55555555f - log_height);
    const float aerosol =
        air.dust * kAerosolDensity *
        (std::exp(-height / kAerosolScale) + kAerosolBackground / kAerosolDensity);
    Coefficients c;
    c.molecules = air.air * std::exp(-0.07771971f * std::pow(height, 1.16364243f)) * kMolecules;
    c.aerosol = aerosol * kAerosolScattering;
    c.extinction = c.molecules + c.aerosol + aerosol * kAerosolAbsorption +
                   air.ozone * ozone * kDobson * kOzone;
    return c;
}

/// Of the way out of the air.  `cosine` of it to the zenith.
Vec4f transmittance(const Atmosphere& air, float cosine, float height) {
    const Vec3f start(0.0f, 0.0f, kEarthRadius + height), direction = towards(cosine);
    const float step = distance_to(start, direction, kAirRadius) / kSteps;
    Vec4f depth(0.0f);
    for (int i = 0; i < kSteps; ++i) {
        const Vec3f p = start + (static_cast<float>(i) + 0.5f) * step * direction;
        depth += step * coefficients_at(air, height_of(p)).extinction;
    }
    return glm::exp(-depth);
}

float viewer_height(const Atmosphere& air) {
    return std::clamp(air.altitude, 1.0f, 99999.0f) / 1000.0f;
}

}  // namespace

MultipleScattering::MultipleScattering(const Atmosphere& air) : m_air(air) {
    m_table.resize(static_cast<std::size_t>(kHeights) * kCosines);
    parallel_for(m_table.size(), kCosines, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto x = static_cast<float>(i % kCosines), y = static_cast<float>(i / kCosines);
            m_table[i] = transmittance(air, 2.0f * x / (kCosines - 1) - 1.0f,
                                       kThickness * y / (kHeights - 1));
        }
    });
}

Vec4f MultipleScattering::look_up(float cosine, float height) const {
    const float x = (kCosines - 1) * std::clamp(0.5f * cosine + 0.5f, 0.0f, 1.0f);
    const float y = (kHeights - 1) * std::clamp(height / kThickness, 0.0f, 1.0f);
    const int x0 = std::min(static_cast<int>(x), kCosines - 2);
    const int y0 = std::min(static_cast<int>(y), kHeights - 2);
    const float right = x - static_cast<float>(x0), up = y - static_cast<float>(y0);
    const Vec4f* row = m_table.data() + y0 * kCosines + x0;
    return glm::mix(glm::mix(row[0], row[1], right),
                    glm::mix(row[kCosines], row[kCosines + 1], right), up);
}

Vec4f MultipleScattering::surroundings(float cosine, float height) const {
    const float sine = kEarthRadius / (kEarthRadius + height);
    const float solid_angle = 2.0f * kPi * (1.0f - std::sqrt(1.0f - sine * sine));  // of the ground
    const Vec4f from_ground = look_up(1.0f, 0.0f) / look_up(1.0f, height);
    const Vec4f ground = solid_angle / (4.0f * kPi) * (kGroundAlbedo / kPi) * cosine *
                         look_up(cosine, 0.0f) * from_ground;
    return ground + kScatteredOften / (1.0f + 5.0f * std::exp(-17.92f * cosine));
}

/// A step's own scattering is integrated in closed form (Hillaire 2016, "Physically Based Sky,
/// Atmosphere and Cloud Rendering in Frostbite").
Vec3f MultipleScattering::sky(const Vec3f& direction) const {
    const Vec3f to_sun = towards(std::sin(m_air.sun_elevation));
    const float cosine = glm::dot(direction, to_sun);
    const float by_molecules = molecule_phase(cosine), by_aerosol = aerosol_phase(cosine);
    const Vec3f start(0.0f, 0.0f, kEarthRadius + viewer_height(m_air));
    const float to_ground = distance_to(start, direction, kEarthRadius);
    const float length = to_ground < 0.0f ? distance_to(start, direction, kAirRadius) : to_ground;
    const float step = length / kSteps;
    Vec4f light(0.0f), left(1.0f);
    for (int i = 0; i < kSteps; ++i) {
        const Vec3f p = start + (static_cast<float>(i) + 0.5f) * step * direction;
        const float height = height_of(p), up = glm::dot(glm::normalize(p), to_sun);
        const Coefficients c = coefficients_at(m_air, height);
        const Vec4f sun = look_up(up, height), rest = surroundings(up, height);
        const Vec4f scattered = kIrradiance * (c.molecules * (by_molecules * sun + rest) +
                                               c.aerosol * (by_aerosol * sun + rest));
        const Vec4f passed = glm::exp(-step * c.extinction);
        light += left * scattered * (1.0f - passed) / glm::max(c.extinction, Vec4f(1e-7f));
        left *= passed;
    }
    return xyz_of(light);
}

Vec3f MultipleScattering::sun(const Atmosphere& air, float elevation, float angular_diameter) {
    const float solid_angle = 2.0f * kPi * (1.0f - std::cos(0.5f * angular_diameter));
    return xyz_of(kIrradiance * transmittance(air, std::sin(elevation), viewer_height(air)) /
                  solid_angle);
}

}  // namespace granita
