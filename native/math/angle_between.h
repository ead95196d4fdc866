// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// Radians between unit vectors, accurate at small angles, other than an arc cosine (Kahan 2006,
/// "How Futile are Mindless Assessments of Roundoff", 13).
inline float angle_between(const Vec3f& a, const Vec3f& b) {
    return 2.0f * std::atan2(glm::length(a - b), glm::length(a + b));
}

}  // namespace granita
