// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// Unit, or `otherwise` where there is no direction.
template <class T>
glm::vec<3, T> normalize_or(const glm::vec<3, T>& v, const glm::vec<3, T>& otherwise) {
    const T length = glm::length(v);
    return length > T(0) && std::isfinite(length) ? v / length : otherwise;
}

inline Vec3f normalize_or(const Vec3f& v, const Vec3f& otherwise) {
    const float length = glm::length(v);
    return length > 0.0f && std::isfinite(length) ? v / length : otherwise;
}

}  // namespace granita
