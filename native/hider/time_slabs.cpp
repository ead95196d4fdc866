// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/time_slabs.h"

#include <algorithm>
#include <utility>

#include "dice/raster_bound.h"

namespace granita {
namespace {

constexpr int kLeastSlabs = 8;

/// Box of the finite vertices at a part of the segment from `knot` on.
Bounds3f box_at(const Grid& grid, int knot, float part) {
    const Vec3f* const begin = grid.positions.data() + knot * grid.vertex_count();
    const Vec3f* const end = begin + grid.vertex_count();
    Bounds3f box;
    for (int v = 0; v < grid.vertex_count(); ++v)
        if (is_finite(begin[v]) && is_finite(end[v]))
            box.add(begin[v] + part * (end[v] - begin[v]));
    return box;
}

}  // namespace

std::vector<TimeSlab> time_slabs(const Grid& grid, const Projection& projection) {
    const int segments = grid.knots - 1;
    const int parts = (kLeastSlabs + segments - 1) / segments;
    std::vector<TimeSlab> slabs;
    Bounds3f begin = box_at(grid, 0, 0.0f);
    for (int segment = 0; segment < segments; ++segment)
        for (int part = 0; part < parts; ++part) {
            const auto time = [&](int p) {
                return static_cast<float>(segment * parts + p) /
                       static_cast<float>(segments * parts);
            };
            const auto fraction = [&](int p) {
                return static_cast<float>(p) / static_cast<float>(parts);
            };
            // At the end of the part; it begins where the last one ended.
            const Bounds3f end = box_at(grid, segment, fraction(part + 1));
            Bounds3f box = std::exchange(begin, end);
            box.add(end);
            RasterBounds bounds;
            if (!box.empty()) {
                // More than single precision moves anything.
                const Vec3f largest = glm::max(glm::abs(box.lo), glm::abs(box.hi));
                box.grow(4e-6f * std::max({largest.x, largest.y, largest.z}));
                bounds = raster_bound(projection, box);
            }
            slabs.push_back({time(part), time(part + 1), bounds});
        }
    return slabs;
}

}  // namespace granita
