// SPDX-License-Identifier: GPL-3.0-or-later
// The grids of a bucket as one array of vertices and one of triangles, ready for the device.
#pragma once

#include <cstdint>
#include <vector>

#include "dice/grid.h"
#include "math/bounds.h"

namespace granita {

/// Grids follow GridKey and micropolygons their index, whatever the order they were handed over in:
/// OpenGL keeps the first of equal depths, so ties fall as GridPool::before decides (decision 3).
class RasterGeometry {
  public:
    struct Range {
        const Grid* grid;
        std::uint32_t input;         ///< index in the list handed over
        std::uint32_t first_vertex;  ///< of `positions`
        std::uint32_t first_index;   ///< of `indices`
        std::uint32_t index_count;
    };
    struct Place {
        std::uint32_t input;
        int micropolygon;
    };

    explicit RasterGeometry(const std::vector<const Grid*>& grids);

    const std::vector<Range>& ranges() const { return m_ranges; }
    const std::vector<Vec3f>& positions() const { return m_positions; }
    /// Two triangles a micropolygon, its corner 0 first in both.
    const std::vector<std::uint32_t>& indices() const { return m_indices; }
    /// Premultiplied colour and coverage a vertex; holdouts are 0 throughout.  0 for grids that
    /// were not shaded.
    std::vector<Vec4f> radiance() const;
    /// The micropolygon whose corner 0 is that vertex.
    Place locate(std::uint32_t vertex) const;

    std::uint64_t micropolygons() const { return m_indices.size() / 6; }
    std::uint64_t dropped() const { return m_dropped; }  ///< non-finite micropolygons

  private:
    void append(const Grid& grid, std::uint32_t input);

    std::vector<Range> m_ranges;
    std::vector<Vec3f> m_positions;
    std::vector<std::uint32_t> m_indices;
    std::uint64_t m_dropped = 0;
};

}  // namespace granita
