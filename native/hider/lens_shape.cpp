// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/lens_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace granita {

LensShape::LensShape(int blades, float rotation_rad, float ratio)
    : m_blades(blades < 3 ? 0 : std::min(blades, 64)),
      m_narrow(ratio > 0.0f ? 1.0f / ratio : 1.0f) {
    // Side k of the polygon faces the direction rotation + 2 pi k / blades.
    for (int k = 0; k <= m_blades; ++k) {
        const double angle = rotation_rad + std::numbers::pi * (2.0 * k - 1.0) / m_blades;
        m_corner_x[k] = static_cast<float>(std::cos(angle));
        m_corner_y[k] = static_cast<float>(std::sin(angle));
    }
}

void LensShape::map(float* u, float* v, std::size_t count) const {
    if (m_blades == 0)
        map_disc(u, v, count);
    else
        map_polygon(u, v, count);
    for (std::size_t i = 0; i < count; ++i) u[i] *= m_narrow;
}

// Concentric map (Shirley and Chiu 1997): the angle within a wedge is q = (b / a) pi / 4, |q| <= pi
// / 4, where sine and cosine are short polynomials (Taylor; the first term left out is below 4e-8).
void LensShape::map_disc(float* u, float* v, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
        const float x = 2.0f * u[i] - 1.0f, y = 2.0f * v[i] - 1.0f;
        const bool wide = std::fabs(x) > std::fabs(y);
        const float radius = wide ? x : y, other = wide ? y : x;
        const float q = radius != 0.0f ? other / radius * 0.78539816f : 0.0f;
        const float q2 = q * q;
        const float sine =
            q + q * q2 * (-1.0f / 6 + q2 * (1.0f / 120 + q2 * (-1.0f / 5040 + q2 / 362880)));
        const float cosine =
            1.0f + q2 * (-0.5f + q2 * (1.0f / 24 + q2 * (-1.0f / 720 + q2 / 40320)));
        u[i] = radius * (wide ? cosine : sine);
        v[i] = radius * (wide ? sine : cosine);
    }
}

// The first number picks the wedge; the rest of it and the second one a point of the wedge's
// triangle.
void LensShape::map_polygon(float* u, float* v, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
        const float place = u[i] * static_cast<float>(m_blades);
        const int k = std::min(static_cast<int>(place), m_blades - 1);
        const float r = std::sqrt(place - static_cast<float>(k)), s = v[i];
        u[i] = r * ((1.0f - s) * m_corner_x[k] + s * m_corner_x[k + 1]);
        v[i] = r * ((1.0f - s) * m_corner_y[k] + s * m_corner_y[k + 1]);
    }
}

}  // namespace granita
