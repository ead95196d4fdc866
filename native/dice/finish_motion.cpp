// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/finish_motion.h"

#include <algorithm>

#include "dice/raster_bound.h"

namespace granita {

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

void finish_motion(Grid& grid, const Projection& projection) {
    find_motion(grid);
    grid.bounds = raster_bound(projection, grid.positions);
}

void set_frame_positions(Grid& grid, const Knots& knots) {
    if (!grid.motion) return;
    const std::size_t count = static_cast<std::size_t>(grid.vertex_count());
    const std::size_t first = static_cast<std::size_t>(knots.frame_knot) * count;
    const double fraction = knots.frame_fraction;
    grid.p.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        grid.p[i] = fraction == 0.0 ? grid.positions[first + i]
                                    : Vec3f(Vec3d(grid.positions[first + i]) * (1.0 - fraction) +
                                            Vec3d(grid.positions[first + count + i]) * fraction);
}

}  // namespace granita
