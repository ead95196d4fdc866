// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "math/vec.h"

namespace granita {

/// The unit square -> the lens: a disc, or a regular polygon of that circumference (Cycles'
/// blades), narrowed in u or v (Projection::lens_extent()).  Equal areas keep equal areas.  Plain
/// float arithmetic without library functions, so that every machine makes the same bits.
class LensShape {
  public:
    LensShape(int blades, float rotation_rad, const Vec2f& extent);
    /// In place: (u[i], v[i]) in [0, 1)^2 become lens points.
    void map(float* u, float* v, std::size_t count) const;
    /// Largest |u| and |v| of a lens point.
    const Vec2f& extent() const { return m_extent; }

  private:
    void map_polygon(float* u, float* v, std::size_t count) const;

    int m_blades;
    Vec2f m_extent;
    float m_corner_x[65], m_corner_y[65];  ///< the polygon's corners, the first again at the end
};

}  // namespace granita
