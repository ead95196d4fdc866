// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "geometry/corner_values.h"
#include "math/normalize_or.h"
#include "math/vec.h"

namespace granita {

/// Unit across a face with these corners and, at a place, derivatives.
inline Vec3d face_direction(const Vec3d* corners, const Vec3d& su, const Vec3d& sv) {
    const Vec3d cross = glm::cross(su, sv);
    const double length = glm::length(cross);
    if (length > 0.0 && std::isfinite(length)) return cross / length;
    // At a corner where two vertices coincide the quad's own normal stands in.  Any direction will
    // do for a face without area: it covers nothing.
    const Vec3d across = glm::cross(corners[2] - corners[0], corners[3] - corners[1]);
    return normalize_or(across, Vec3d(0.0, 0.0, -1.0));
}

/// A polygon's patch at the frame time, camera space: what it is shaded by.
struct FrameFace {
    Vec3d p[4]{};              ///< corners; a triangle repeats its last
    Vec3d normal[4]{};         ///< of the corners, unit or zero; read where `is_smooth`
    bool is_smooth = false;    ///< normals are linear between the corners'
    double orientation = 1.0;  ///< -1: mirrored

    Vec3d by_u(const CornerWeights& weights) const { return blend(p, weights.du); }
    Vec3d by_v(const CornerWeights& weights) const { return blend(p, weights.dv); }
    /// Unit, of the face itself, where its derivatives are `su` and `sv`.
    Vec3d geometric_normal(const Vec3d& su, const Vec3d& sv) const {
        return orientation * face_direction(p, su, sv);
    }
    /// Unit, of shading, where the face has this normal itself.
    Vec3d shading_normal(const CornerWeights& weights, const Vec3d& geometric_normal) const {
        return is_smooth ? normalize_or(blend(normal, weights.w), geometric_normal)
                         : geometric_normal;
    }
};

}  // namespace granita
