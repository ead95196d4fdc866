// SPDX-License-Identifier: GPL-3.0-or-later
// GLM under short names.  Spaces are in the names of variables: p_object, p_camera, p_raster.
#pragma once

#define GLM_FORCE_SILENT_WARNINGS
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/glm.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

namespace granita {

using Vec2f = glm::vec2;
using Vec3f = glm::vec3;
using Vec4f = glm::vec4;
using Vec2d = glm::dvec2;
using Vec3d = glm::dvec3;
using Vec2i = glm::ivec2;
using Mat3f = glm::mat3;
using Mat3d = glm::dmat3;
/// Column vectors, m * p; transforms are named destination_from_source so that products chain.
using Mat4d = glm::dmat4;

inline bool is_finite(const Vec3f& v) {
    return glm::all(glm::not_(glm::isnan(v))) && glm::all(glm::not_(glm::isinf(v)));
}

/// Of its three numbers.
inline float largest(const Vec3f& v) {
    return glm::max(glm::max(v.x, v.y), v.z);
}

inline Vec3d transform_point(const Mat4d& m, const Vec3d& p) {
    return Vec3d(m * glm::dvec4(p, 1.0));
}

}  // namespace granita
