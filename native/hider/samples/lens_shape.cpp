// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/samples/lens_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hider/samples/lens_kernel.h"

namespace granita {

LensShape::LensShape(int blades, float rotation_rad, const Vec2f& extent)
    : m_blades(blades < 3 ? 0 : std::min(blades, 64)), m_extent(extent) {
    // Side k of the polygon faces the direction rotation + 2 pi k / blades.
    for (int k = 0; k <= m_blades; ++k) {
        const double angle = rotation_rad + std::numbers::pi * (2.0 * k - 1.0) / m_blades;
        m_corner_x[k] = static_cast<float>(std::cos(angle));
        m_corner_y[k] = static_cast<float>(std::sin(angle));
    }
}

void LensShape::map(float* u, float* v, std::size_t count) const {
    if (m_blades == 0)
        map_to_disc(u, v, count);
    else
        map_polygon(u, v, count);
    for (std::size_t i = 0; i < count; ++i) {
        u[i] *= m_extent.x;
        v[i] *= m_extent.y;
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
