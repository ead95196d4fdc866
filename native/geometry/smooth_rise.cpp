// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/smooth_rise.h"

#include <algorithm>
#include <limits>

namespace granita {

Vec4f smooth_rise(const Vec3d (&p)[4], const Vec3d (&normals)[4], const CornerWeights& weights,
                  bool above) {
    // Of the pair's triangles the one that the place is on.
    const std::size_t second = weights.w[3] > 0.0 ? 2 : 1;
    const std::size_t corner[3] = {0, second, second + 1};
    const double side = above ? 1.0 : -1.0;
    const Vec3d place = blend(p, weights.w);
    double curved = 0.0;  // height of the parabola through the corners, doubled
    double lowest = std::numeric_limits<double>::infinity();  // of the corners' tangent planes
    double to_side = lowest;
    const double area = glm::length(glm::cross(p[corner[1]] - p[0],
                                               p[corner[2]] - p[0]));  // doubled
    for (int i = 0; i < 3; ++i) {
        const Vec3d &at = p[corner[i]], &normal = normals[corner[i]];
        const double opposite = glm::distance(p[corner[(i + 1) % 3]], p[corner[(i + 2) % 3]]);
        if (opposite > 0.0) to_side = std::min(to_side, weights.w[corner[i]] * area / opposite);
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
    const Vec3d rise = blend(normals, weights.w) * (side * std::max(lowest, 0.5 * side * curved));
    return {Vec3f(rise), static_cast<float>(to_side)};
}

}  // namespace granita
