// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/motion_bounds.h"

#include <algorithm>

#include "dice/raster_bound.h"

namespace granita {
namespace {

/// Of a vertex of what moves.
Vec3f frame_position(const Grid& grid, const Knots& knots, std::size_t vertex) {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    const std::size_t at = static_cast<std::size_t>(knots.frame_knot) * count + vertex;
    const double fraction = knots.frame_fraction;
    if (fraction == 0.0) return grid.positions[at];
    return Vec3f(Vec3d(grid.positions[at]) * (1.0 - fraction) +
                 Vec3d(grid.positions[at + count]) * fraction);
}

}  // namespace

void find_motion(Grid& grid) {
    grid.motion = false;
    const std::size_t count = static_cast<std::size_t>(grid.vertex_count());
    for (int k = 1; k < grid.knots && !grid.motion; ++k)
        grid.motion = !std::equal(grid.positions.begin(),
                                  grid.positions.begin() + static_cast<std::ptrdiff_t>(count),
                                  grid.positions.begin() + k * static_cast<std::ptrdiff_t>(count));
    if (!grid.motion && grid.lifespan.is_whole()) {
        grid.knots = 1;
        grid.positions.resize(count);
    } else if (grid.knots == 1) {
        grid.knots = 2;
        grid.positions.resize(2 * count);
        std::copy_n(grid.positions.begin(), count,
                    grid.positions.begin() + static_cast<std::ptrdiff_t>(count));
    }
    grid.motion = grid.knots > 1;
}

void motion_bounds(Grid& grid, const Projection& projection) {
    find_motion(grid);
    grid.bounds = raster_bound(projection, grid.positions);
}

void set_frame_positions(Grid& grid, const Knots& knots) {
    if (!grid.motion) return;
    grid.p.resize(static_cast<std::size_t>(grid.vertex_count()));
    for (std::size_t i = 0; i < grid.p.size(); ++i) grid.p[i] = frame_position(grid, knots, i);
}

void set_point_positions(Grid& grid, const Knots& knots) {
    grid.p.clear();
    for (const std::uint32_t anchor : grid.shading_positions.anchors)
        grid.p.push_back(grid.motion ? frame_position(grid, knots, anchor)
                                     : grid.positions[anchor]);
}

}  // namespace granita
