// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/normalize_or.h"
#include "math/vec.h"

namespace granita {

/// A surface at a point and the frame time, camera space.
struct TangentFrame {
    Vec3d su, sv;                    ///< derivatives by u and v
    Vec3d normal, geometric_normal;  ///< unit; `normal` is of shading

    /// The tangents move as the offsets change, by u and v.  The shading normal is that of the
    /// smooth surface which has it where nothing is displaced: whose tangents are square to it.
    /// `orientation` -1: mirrored.
    void displace(const Vec3d& by_u, const Vec3d& by_v, double orientation) {
        const Vec3d flat_u = su - normal * glm::dot(normal, su);
        const Vec3d flat_v = sv - normal * glm::dot(normal, sv);
        su += by_u;
        sv += by_v;
        geometric_normal = normalize_or(orientation * glm::cross(su, sv), geometric_normal);
        normal = normalize_or(orientation * glm::cross(flat_u + by_u, flat_v + by_v), normal);
    }
};

}  // namespace granita
