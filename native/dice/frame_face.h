// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "dice/tangent_frame.h"
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
    Vec3d p[4]{};            ///< corners, not displaced; a triangle repeats its last
    Vec3d normal[4]{};       ///< of the corners, unit or zero; read where `is_smooth`
    Vec3d moved[4]{};        ///< how far displacement moves the corners; read where `is_displaced`
    bool is_smooth = false;  ///< normals are linear between the corners'
    bool is_displaced = false;  ///< offsets are
    double orientation = 1.0;   ///< -1: mirrored

    /// Displaced, where it is.
    TangentFrame frame(const CornerWeights& weights) const {
        TangentFrame at;
        at.su = blend(p, weights.du);
        at.sv = blend(p, weights.dv);
        at.geometric_normal = orientation * face_direction(p, at.su, at.sv);
        at.normal = is_smooth ? normalize_or(blend(normal, weights.w), at.geometric_normal)
                              : at.geometric_normal;
        if (is_displaced)
            at.displace(blend(moved, weights.du), blend(moved, weights.dv), orientation);
        return at;
    }
};

}  // namespace granita
