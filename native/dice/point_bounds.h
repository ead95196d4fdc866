// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <span>

#include "math/bounds.h"
#include "math/projection.h"

namespace granita {

/// Where points can be seen: as conservative for everything in their convex hull, since the
/// projection through any one lens point keeps lines straight.
class PointBounds {
  public:
    explicit PointBounds(const Projection& projection);
    /// Finite ones, in whatever pieces.
    void add(std::span<const Vec3f> points);
    /// Also what another has, of the same projection.
    void add(const PointBounds& other);
    RasterBounds bounds() const;
    const Bounds3f& box() const { return m_box; }

  private:
    const Projection* m_projection;
    bool m_perspective;
    float m_radius, m_near_focus, m_far_focus;  ///< of the lens, and 1 / its focuses
    Bounds3f m_box;                             ///< camera space
    Vec2f m_lo{INFINITY}, m_hi{-INFINITY};      ///< slopes, or metres, with what the lens shifts
};

}  // namespace granita
