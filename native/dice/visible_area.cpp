// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/visible_area.h"

#include <cmath>

namespace granita {

double visible_area(const Grid& grid, std::span<const Vec3f> p, const Projection& projection) {
    std::vector<Vec2f> place;
    place.reserve(p.size());
    for (const Vec3f& at : p)
        place.push_back(Vec2f(projection.scale) * Vec2f(at) /
                        (projection.perspective ? at.z : 1.0f));
    double area = 0.0;
    for (int m = 0; m < grid.micropolygon_count(); ++m) {
        const Grid::Corners c = grid.corners(m);
        const Vec2f a =
            place[static_cast<std::size_t>(c.v2)] - place[static_cast<std::size_t>(c.v0)];
        const Vec2f b =
            place[static_cast<std::size_t>(c.v3)] - place[static_cast<std::size_t>(c.v1)];
        area += 0.5 * std::abs(a.x * b.y - a.y * b.x);
    }
    return area;
}

void set_point_share(Grid& grid, double area, double rate) {
    const double share = area / (rate * rate * static_cast<double>(grid.point_count()));
    if (share < 1.0) grid.point_share = static_cast<float>(share);
}

}  // namespace granita
