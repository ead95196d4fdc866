// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// Where light from `wo` comes from that leaves along `wi` through a boundary whose unit normal
/// `n` has wi above it (Snell's law); `ior` of the far side relative to wi's.  False where all is
/// reflected, or wi is below.
inline bool refracted(const Vec3f& wi, const Vec3f& n, float ior, Vec3f& wo) {
    const float cosine = glm::dot(wi, n);
    const float cos2 = 1.0f - (1.0f - cosine * cosine) / (ior * ior);
    if (cosine <= 0.0f || cos2 <= 0.0f) return false;
    wo = glm::normalize((cosine / ior - std::sqrt(cos2)) * n - wi / ior);
    return true;
}

}  // namespace granita
