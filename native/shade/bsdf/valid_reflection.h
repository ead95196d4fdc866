// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace granita {

/// `normal`, or where the view would be mirrored about it into the surface the nearest one, between
/// it and the surface's own, about which it leaves just above: as Cycles has it, half a degree, or
/// nine tenths of the view's own height where that is less.  All unit, the same axes; `geometric`
/// is faced to `view`.
inline Vec3f valid_reflection(const Vec3f& geometric, const Vec3f& view, const Vec3f& normal) {
    const Vec3f mirrored = 2.0f * glm::dot(normal, view) * normal - view;
    const float height = glm::dot(geometric, view);
    const float lowest = std::min(0.9f * height, 0.01f);
    if (glm::dot(geometric, mirrored) >= lowest) return normal;
    const Vec3f across = normal - glm::dot(normal, geometric) * geometric;
    const float length = glm::length(across);
    if (!(length > 0.0f)) return geometric;
    // In the plane of both normals the view is `within` long and leans by `angle`; mirrored about a
    // normal that leans by t it leans by 2 t - angle, and is then within * cos(2 t - angle) high.
    const Vec3f x = across / length;
    const float along = glm::dot(view, x), within = std::hypot(along, height);
    if (!(within > std::abs(lowest))) return geometric;
    const float angle = std::atan2(along, height);
    const float lean = 0.5f * (angle + std::acos(lowest / within));
    return std::sin(lean) * x + std::cos(lean) * geometric;
}

}  // namespace granita
