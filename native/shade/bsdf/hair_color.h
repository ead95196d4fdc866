// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// Chiang et al. 2016, equation 9: many hairs of absorption sigma look like
/// exp(-sqrt(sigma) scale).
inline float hair_absorption_scale(float radial_roughness) {
    const float x = radial_roughness;
    return ((((0.245f * x + 5.574f) * x - 10.73f) * x + 2.532f) * x - 0.215f) * x + 5.969f;
}

/// The absorption of hairs that look like a colour.
inline Vec3f hair_absorption(const Vec3f& color, float radial_roughness) {
    const Vec3f root =
        glm::log(glm::max(color, Vec3f(1e-5f))) / hair_absorption_scale(radial_roughness);
    return root * root;
}

/// The same of melanin (d'Eon et al. 2011), for red, green and blue.
inline Vec3f melanin_absorption(float eumelanin, float pheomelanin) {
    return eumelanin * Vec3f(0.506f, 0.841f, 1.653f) + pheomelanin * Vec3f(0.343f, 0.733f, 1.924f);
}

}  // namespace granita
