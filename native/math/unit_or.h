// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// Unit, or `otherwise` where there is no direction.
inline Vec3d unit_or(const Vec3d& v, const Vec3d& otherwise) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : otherwise;
}

}  // namespace granita
