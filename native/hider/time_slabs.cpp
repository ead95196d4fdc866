// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/time_slabs.h"

#include <algorithm>

#include "dice/raster_bound.h"

namespace granita {
namespace {

constexpr int kLeastSlabs = 8;

Bounds3f box_at(const Grid& grid, int knot) {
    const Vec3f* const points = grid.positions.data() + knot * grid.vertex_count();
    Bounds3f box;
    for (int v = 0; v < grid.vertex_count(); ++v)
        if (is_finite(points[v])) box.add(points[v]);
    return box;
}

/// Positions move linearly between knots, so the box between their boxes holds them.
Bounds3f mix(const Bounds3f& a, const Bounds3f& b, float part) {
    return {a.lo + part * (b.lo - a.lo), a.hi + part * (b.hi - a.hi)};
}

}  // namespace

std::vector<TimeSlab> time_slabs(const Grid& grid, const Projection& projection) {
    const int segments = grid.knots - 1;
    const int parts = (kLeastSlabs + segments - 1) / segments;
    const auto count = static_cast<float>(segments * parts);
    std::vector<TimeSlab> slabs;
    Bounds3f begin = box_at(grid, 0);
    for (int segment = 0; segment < segments; ++segment) {
        const Bounds3f end = box_at(grid, segment + 1);
        for (int part = 0; part < parts; ++part) {
            RasterBounds bounds;
            if (!begin.empty() && !end.empty()) {
                const auto fraction = [&](int p) {
                    return static_cast<float>(p) / static_cast<float>(parts);
                };
                Bounds3f box = mix(begin, end, fraction(part));
                box.add(mix(begin, end, fraction(part + 1)));
                // More than single precision moves anything.
                const Vec3f largest = glm::max(glm::abs(box.lo), glm::abs(box.hi));
                box.grow(4e-6f * std::max({largest.x, largest.y, largest.z}));
                bounds = raster_bound(projection, box);
            }
            const int first = segment * parts + part;
            slabs.push_back(
                {static_cast<float>(first) / count, static_cast<float>(first + 1) / count, bounds});
        }
        begin = end;
    }
    return slabs;
}

}  // namespace granita
