// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hider/lens_shape.h"
#include "hider/simd_kernel.h"
#include "math/projection.h"

namespace granita {

/// A grid's vertices in a tile's homogeneous raster space, subtracted in double (decision 2), with
/// the raster bounds of every vertex over each motion segment and the lens.
class TileGrid {
  public:
    TileGrid(const Projection& projection, const LensShape& lens);
    /// Fills the positions, bounds and lens of `out`, which refers to this object until the next
    /// call.
    void project(const Grid& grid, const Vec2d& origin, SimdGrid& out);

    /// Bound of |u| in pixels per unit shear.
    float lens_x() const { return m_lens_x; }

  private:
    void bound_vertices(std::size_t vertices, std::size_t knots);

    Projection m_projection;
    float m_inverse_focus;
    float m_lens_x = 0.0f, m_lens_y = 0.0f;  ///< largest shift a unit of shear, pixels
    std::vector<float> m_x, m_y, m_w, m_z;
    std::vector<float> m_x_lo, m_x_hi, m_y_lo, m_y_hi;
};

}  // namespace granita
