// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "dice/grid.h"
#include "hider/samples/lens_shape.h"
#include "hider/samples/sample_order.h"
#include "hider/simd/simd_kernel.h"
#include "math/projection.h"

namespace granita {

/// A grid's vertices in a tile's homogeneous raster space, subtracted in double (decision 2), with
/// the raster bounds of every vertex over each motion segment and the lens.
class TileGrid {
  public:
    TileGrid(const Projection& projection, const LensShape& lens);
    /// The grid that project() is about; it must outlive the calls.
    void load(const Grid& grid);
    /// Fills all of `out` but finite, classes, base, pool and range; it refers to this object until
    /// the next call.
    void project(const Vec2d& origin, SimdGrid& out);
    /// How far the grid's micropolygons go, roughly.
    Sweep sweep() const;

  private:
    Projection m_projection;
    float m_inverse_focus, m_inverse_farthest;  ///< SimdGrid::inverse_focus, inverse_farthest
    float m_lens_x = 0.0f, m_lens_y = 0.0f;     ///< largest shift a unit of shear, pixels
    const Grid* m_grid = nullptr;
    std::vector<float> m_px, m_py, m_z;  ///< camera space; padded like the following
    std::vector<float> m_x, m_y, m_w, m_corners;
    std::vector<float> m_x_lo, m_x_hi, m_y_lo, m_y_hi, m_nearest;
};

}  // namespace granita
