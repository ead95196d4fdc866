// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster_geometry.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/check.h"

namespace granita {

RasterGeometry::RasterGeometry(const std::vector<const Grid*>& grids) {
    std::vector<std::uint32_t> order(grids.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return grids[a]->key < grids[b]->key;
    });
    std::size_t vertices = 0, micropolygons = 0;
    for (const Grid* grid : grids) {
        vertices += static_cast<std::size_t>(grid->vertex_count());
        micropolygons += static_cast<std::size_t>(grid->micropolygon_count());
    }
    // Vertex names and index offsets are 32 bits in OpenGL; 0 stands for no surface.
    const std::size_t largest_name = std::max(vertices, 6 * micropolygons);
    GRANITA_CHECK_LT(largest_name, std::numeric_limits<std::uint32_t>::max());
    m_positions.reserve(vertices);
    m_indices.reserve(6 * micropolygons);
    m_ranges.reserve(grids.size());
    for (const std::uint32_t input : order) append(*grids[input], input);
}

void RasterGeometry::append(const Grid& grid, std::uint32_t input) {
    const auto base = static_cast<std::uint32_t>(m_positions.size());
    const auto first_index = static_cast<std::uint32_t>(m_indices.size());
    // Static: all knots are equal.
    m_positions.insert(m_positions.end(), grid.positions.begin(),
                       grid.positions.begin() + grid.vertex_count());
    for (int m = 0; m < grid.micropolygon_count(); ++m) {
        const Grid::Corners c = grid.corners(m);
        const auto finite = [&](int v) { return is_finite(grid.positions[v]); };
        if (!finite(c.v0) || !finite(c.v1) || !finite(c.v2) || !finite(c.v3)) {
            ++m_dropped;
            continue;
        }
        for (const int v : {c.v0, c.v1, c.v2, c.v0, c.v2, c.v3})
            m_indices.push_back(base + static_cast<std::uint32_t>(v));
    }
    m_ranges.push_back({&grid, input, base, first_index,
                        static_cast<std::uint32_t>(m_indices.size()) - first_index});
}

std::vector<Vec4f> RasterGeometry::radiance() const {
    std::vector<Vec4f> colors(m_positions.size(), Vec4f(0.0f));
    for (const Range& range : m_ranges) {
        if (range.grid->holdout) continue;
        for (std::size_t v = 0; v < range.grid->radiance.size(); ++v)
            colors[range.first_vertex + v] = Vec4f(range.grid->radiance[v], 1.0f);
    }
    return colors;
}

RasterGeometry::Place RasterGeometry::locate(std::uint32_t vertex) const {
    const auto after =
        std::upper_bound(m_ranges.begin(), m_ranges.end(), vertex,
                         [](std::uint32_t v, const Range& r) { return v < r.first_vertex; });
    GRANITA_CHECK(after != m_ranges.begin());
    const Range& range = *(after - 1);
    const auto local = static_cast<int>(vertex - range.first_vertex);
    const int stride = range.grid->n_u + 1;
    return {range.input, local / stride * range.grid->n_u + local % stride};
}

}  // namespace granita
