// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/daylight.h"

#include <algorithm>
#include <cmath>

#include "math/angle_between.h"
#include "math/sampling.h"

namespace granita {
namespace {

/// What Cycles shows of a thousand candelas a square metre.
constexpr float kScale = 0.06f;
/// The model has no horizon: directions end a little above it.
constexpr float kLowest = 0.001f;

float cubic(float t, float a, float b, float c, float d) {
    return ((a * t + b) * t + c) * t + d;
}

}  // namespace

float Daylight::Distribution::at(float cosine, float gamma) const {
    const float to_sun = std::cos(gamma);
    return (1.0f + c[0] * std::exp(c[1] / cosine)) *
           (1.0f + c[2] * std::exp(c[3] * gamma) + c[4] * to_sun * to_sun);
}

// The paper's appendix A.2.
Daylight::Daylight(const Vec3f& to_sun, float t)
    : m_to_sun(to_sun),
      m_luminance{{0.1787f * t - 1.4630f, -0.3554f * t + 0.4275f, -0.0227f * t + 5.3251f,
                   0.1206f * t - 2.5771f, -0.0670f * t + 0.3703f}},
      m_x{{-0.0193f * t - 0.2592f, -0.0665f * t + 0.0008f, -0.0004f * t + 0.2125f,
           -0.0641f * t - 0.8989f, -0.0033f * t + 0.0452f}},
      m_y{{-0.0167f * t - 0.2608f, -0.0950f * t + 0.0092f, -0.0079f * t + 0.2102f,
           -0.0441f * t - 1.6537f, -0.0109f * t + 0.0529f}} {
    const float sun = angle_between(to_sun, Vec3f(0.0f, 0.0f, 1.0f));
    const float chi = (4.0f / 9.0f - t / 120.0f) * (kPi - 2.0f * sun);
    const float luminance =
        kScale * ((4.0453f * t - 4.9710f) * std::tan(chi) - 0.2155f * t + 2.4192f);
    const float x = (cubic(sun, 0.00166f, -0.00375f, 0.00209f, 0.0f) * t +
                     cubic(sun, -0.02903f, 0.06377f, -0.03202f, 0.00394f)) *
                        t +
                    cubic(sun, 0.11693f, -0.21196f, 0.06052f, 0.25886f);
    const float y = (cubic(sun, 0.00275f, -0.00610f, 0.00317f, 0.0f) * t +
                     cubic(sun, -0.04214f, 0.08970f, -0.04153f, 0.00516f)) *
                        t +
                    cubic(sun, 0.15346f, -0.26756f, 0.06670f, 0.26688f);
    m_luminance.zenith = luminance / m_luminance.at(1.0f, sun);
    m_x.zenith = x / m_x.at(1.0f, sun);
    m_y.zenith = y / m_y.at(1.0f, sun);
}

Vec3f Daylight::xyz(const Vec3f& direction) const {
    const float cosine = std::max(direction.z, std::sin(kLowest));
    const float gamma = angle_between(direction, m_to_sun);
    const float luminance = m_luminance.zenith * m_luminance.at(cosine, gamma);
    const float x = m_x.zenith * m_x.at(cosine, gamma);
    const float y = m_y.zenith * m_y.at(cosine, gamma);
    if (!(y > 0.0f)) return Vec3f(0.0f);
    return Vec3f(x, y, 1.0f - x - y) * (luminance / y);
}

}  // namespace granita
