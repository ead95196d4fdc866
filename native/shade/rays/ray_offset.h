// SPDX-License-Identifier: GPL-3.0-or-later
// Rays start off the surface that they leave, as far as its triangles and rounding may lie above.
#pragma once

#include <algorithm>

#include "math/vec.h"

namespace granita {

/// Where a ray from a grid's point `p` must start so as to clear the grid's own triangles: lifted
/// along the geometric normal by the rounding of positions and by the largest distance between the
/// surface and its triangles.
struct RayOffset {
    float distance = 0.0f;  ///< of the object's origin from that of shading space, metres
    float extent = 0.0f;    ///< largest coordinate of the face in its object, metres
    float error = 0.0f;     ///< between surface and triangles, metres
    bool casts = false;     ///< false: rays meet no triangles of it

    /// Positions are rounded to float in shading space and again in object space, each to 2^-24 of
    /// the largest coordinate on the way; 2^-20 leaves room for a dozen such steps.
    static constexpr float kRounding = 0x1p-20f;

    /// Metres.
    float length(const Vec3f& p) const {
        float size = glm::length(p);  // of all numbers on the way, summed
        if (casts) {
            const float from_origin = size + distance;  // of p, at most
            size = from_origin + std::max(from_origin, extent);
        }
        return kRounding * size + error;
    }
    Vec3f operator()(const Vec3f& p, const Vec3f& geometric_normal) const {
        return p + geometric_normal * length(p);
    }
};

}  // namespace granita
