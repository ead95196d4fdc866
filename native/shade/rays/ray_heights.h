// SPDX-License-Identifier: GPL-3.0-or-later
// How far a surface stands off the triangles that rays meet of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace granita {

/// How far something with this offset from a triangle's plane may stand off the triangle, along
/// the face's own normal.  Only what leaves the plane counts: a flat trapezoid's patch is not
/// linear in its parameters, but lies in its triangles all the same.  Normals of any length.
inline float height_off(const Vec3f& offset, const Vec3f& triangle, const Vec3f& face) {
    const float area = glm::length(triangle);
    if (!(area > 0.0f)) return 0.0f;  // no triangle for a ray to hit
    const float cosine = std::abs(glm::dot(triangle, face)) / glm::length(face);
    return std::min(glm::length(offset), std::abs(glm::dot(offset, triangle)) / cosine);
}

/// The same of a quad cut from a to c: the larger of its two triangles'.
inline float height_off(const Vec3f& offset, const Vec3f& a, const Vec3f& b, const Vec3f& c,
                        const Vec3f& d) {
    const Vec3f face = glm::cross(c - a, d - b);
    return std::max(height_off(offset, glm::cross(b - a, c - a), face),
                    height_off(offset, glm::cross(c - a, d - a), face));
}

/// 0 where p is not finite: rays meet nothing there.
inline float largest_coordinate(const Vec3f& p) {
    return is_finite(p) ? std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) : 0.0f;
}

}  // namespace granita
