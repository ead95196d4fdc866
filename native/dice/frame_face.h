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

/// Unit, of the smooth surface that has the normal `n` and these tangents before it is displaced:
/// of one whose tangents are square to it and move as the offsets change.
inline Vec3d displaced_normal(const Vec3d& n, const Vec3d& su, const Vec3d& sv, const Vec3d& by_u,
                              const Vec3d& by_v, double orientation) {
    const Vec3d flat_u = su - n * glm::dot(n, su), flat_v = sv - n * glm::dot(n, sv);
    return normalize_or(orientation * glm::cross(flat_u + by_u, flat_v + by_v), n);
}

/// A polygon's patch at the frame time, camera space: what it is shaded by.
struct FrameFace {
    Vec3d p[4]{};       ///< corners; a triangle repeats its last
    Vec3d normal[4]{};  ///< of the corners, unit or zero; read where `is_smooth`
    Vec3d moved[4]{};   ///< how far displacement has moved the corners
    bool is_displaced = false;
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
        if (!is_smooth) return geometric_normal;
        const Vec3d smooth = normalize_or(blend(normal, weights.w), geometric_normal);
        if (!is_displaced) return smooth;
        const Vec3d by_u_moved = blend(moved, weights.du), by_v_moved = blend(moved, weights.dv);
        return displaced_normal(smooth, by_u(weights) - by_u_moved, by_v(weights) - by_v_moved,
                                by_u_moved, by_v_moved, orientation);
    }
};

}  // namespace granita
