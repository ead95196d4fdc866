// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace granita {

/// The unit square -> the lens: a disc, or a regular polygon of that circumference (Cycles'
/// blades), narrowed in x by the ratio.  Equal areas keep equal areas.  Plain float arithmetic
/// without library functions, so that every machine makes the same bits.
class LensShape {
  public:
    LensShape(int blades, float rotation_rad, float ratio);
    /// In place: (u[i], v[i]) in [0, 1)^2 become lens points.
    void map(float* u, float* v, std::size_t count) const;
    /// Largest |u| and |v| of a lens point.
    float extent_u() const { return m_narrow > 1.0f ? m_narrow : 1.0f; }
    float extent_v() const { return 1.0f; }

  private:
    void map_polygon(float* u, float* v, std::size_t count) const;

    int m_blades;
    float m_narrow;                        ///< 1 / ratio
    float m_corner_x[65], m_corner_y[65];  ///< the polygon's corners, the first again at the end
};

}  // namespace granita
