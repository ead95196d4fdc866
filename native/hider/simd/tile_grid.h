// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "dice/grid.h"
#include "hider/samples/lens_shape.h"
#include "hider/samples/sample_order.h"
#include "hider/simd/project_vertices.h"
#include "hider/simd/simd_kernel.h"
#include "math/projection.h"

namespace granita {

/// A grid's vertices in a tile's homogeneous raster space, subtracted in double (decision 2): of
/// the parts of the grid that touch the tile, segment by segment.  What turns has 16 segments and
/// is over a tile during some of them: projecting and bounding all for every tile was 27 % of
/// hiding feathers whose faces share grids.
class TileGrid {
  public:
    TileGrid(const Projection& projection, const LensShape& lens);
    /// The grid that project() is about; it must outlive the calls.
    void load(const Grid& grid);
    /// All but finite, classes, base, pool and range; refers to this object until the next call.
    SimdGrid project(const Vec2d& origin);
    /// How far the grid's micropolygons go, roughly.
    Sweep sweep() const;

  private:
    /// A part during one segment.
    struct BoundedPart {
        Patch patch;
        PartBounds bounds;
    };

    /// Finds the bounds, when the first tile asks.
    void bound();
    /// The parts that may touch the tile.
    void find_parts();
    /// Notes that these vertices are needed, by their number among those of all knots.
    void need(std::size_t first, std::size_t count);
    /// Calls visit(first, count) for runs of vertices that are needed, and some around them.
    template <class Visit>
    void for_each_needed(Visit visit) const;

    Projection m_projection;
    float m_inverse_focus, m_inverse_farthest;  ///< SimdGrid::inverse_focus, inverse_farthest
    float m_lens_x = 0.0f, m_lens_y = 0.0f;     ///< largest shift a unit of shear, pixels
    const Grid* m_grid = nullptr;
    std::vector<float> m_px, m_py, m_z;  ///< camera space; padded like the following
    std::vector<float> m_x, m_y, m_w, m_corners;
    std::vector<float> m_x_lo, m_x_hi, m_y_lo, m_y_hi, m_nearest;
    std::vector<BoundedPart> m_parts;     ///< of all segments; none yet: not bounded
    std::vector<GridPart> m_over;         ///< the tile
    std::vector<std::uint64_t> m_needed;  ///< a bit for each vector of vertices of all knots
    int m_together = 1;                   ///< SimdGrid::together
    SimdGrid m_simd;
};

}  // namespace granita
