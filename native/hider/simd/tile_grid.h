// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/grid_sweep.h"
#include "hider/simd/simd_kernel.h"
#include "math/projection.h"

namespace granita {

/// A grid's vertices in a tile's homogeneous raster space, subtracted in double (decision 2): of
/// the parts of the grid that touch the tile, segment by segment.  What turns has 16 segments and
/// is over a tile during some of them: projecting all for every tile was 27 % of hiding feathers
/// whose faces share grids.
class TileGrid {
  public:
    TileGrid(const Projection& projection, const LensShape& lens);
    /// The grid that project() is about; it must outlive the calls.
    void load(const GridSweep& sweep);
    /// All but base, pool and range; refers to this object until the next call.
    SimdGrid project(const Vec2d& origin);

  private:
    /// The parts that may touch the tile, and their vertices.
    void find_parts(const Vec2d& origin);
    /// Notes that these vertices are needed, by their number among those of all knots.
    void need(std::size_t first, std::size_t count);
    /// Calls visit(first, count) for runs of vertices that are needed, and some around them.
    template <class Visit>
    void for_each_needed(Visit visit) const;

    Projection m_projection;
    const GridSweep* m_sweep = nullptr;
    std::vector<float> m_px, m_py, m_z;  ///< camera space; padded like the following
    std::vector<float> m_x, m_y, m_w, m_corners;
    std::vector<PartSegment> m_over;     ///< the tile
    std::vector<std::uint8_t> m_needed;  ///< [vectors of vertices of all knots]
    SimdGrid m_simd;
};

}  // namespace granita
