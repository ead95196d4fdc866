// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/smooth_rise.h"

#include <algorithm>
#include <limits>

namespace granita {

Vec3f smooth_rise(const Vec3d (&p)[4], const Vec3d (&normals)[4], const CornerWeights& weights,
                  bool above) {
    // Of the pair's triangles the one that the place is on.
    const std::size_t second = weights.w[3] > 0.0 ? 2 : 1;
    const std::size_t corner[3] = {0, second, second + 1};
    const double side = above ? 1.0 : -1.0;
    const Vec3d place = blend(p, weights.w);
    double curved = 0.0;  // height of the parabola through the corners, doubled
    double lowest = std::numeric_limits<double>::infinity();  // of the corners' tangent planes
    for (int i = 0; i < 3; ++i) {
        const Vec3d &at = p[corner[i]], &normal = normals[corner[i]];
        double reach = 0.0;  // what stands above the plane
        for (int k = 0; k < 3; ++k) {
            const Vec3d way = p[corner[k]] - at;
            reach = std::max(reach, side * glm::dot(way, normal));
            if (k > i)
                curved += weights.w[corner[i]] * weights.w[corner[k]] *
                          glm::dot(normals[corner[k]] - normal, way);
        }
        lowest = std::min(lowest, std::max(side * glm::dot(at - place, normal) + reach, 0.0));
    }
    return Vec3f(blend(normals, weights.w) * (side * std::max(lowest, 0.5 * side * curved)));
}

}  // namespace granita
