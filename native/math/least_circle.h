// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/projection.h"

namespace granita {

/// The smallest circle of confusion among places, whenever within the shutter: that within what an
/// anamorphic lens makes of it.
class LeastCircle {
  public:
    explicit LeastCircle(const Projection& projection)
        : m_projection(projection),
          m_near(projection.perspective ? std::max(projection.near_clip, 1e-9) : 0.0) {}

    /// A place at camera-space depth z, metres.
    void add(double z) {
        if (m_projection.perspective && !(z >= m_near)) {
            m_sharp = true;
            return;
        }
        const double w = m_projection.perspective ? 1.0 / z : 1.0;
        for (const double focus : {m_projection.focus, m_projection.farthest_focus()}) {
            const double shear = z / focus - 1.0;
            (shear < 0.0 ? m_before : m_behind) = true;
            m_smallest = std::min(m_smallest, std::abs(shear) * w);
        }
    }
    /// Pixels; 0 where the sharp plane passes between the places, or one is not before the camera.
    double diameter() const {
        if (m_sharp || (m_before && m_behind) || !(m_before || m_behind)) return 0.0;
        const double narrowest = m_projection.lens_radius - m_projection.lens_closing;
        const Vec2d axes = m_projection.lens_extent() * glm::abs(m_projection.scale);
        return 2.0 * m_smallest * narrowest * std::min(axes.x, axes.y);
    }

  private:
    const Projection& m_projection;
    double m_near;
    double m_smallest = std::numeric_limits<double>::infinity();
    bool m_before = false, m_behind = false, m_sharp = false;
};

}  // namespace granita
