// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace granita {

/// Radiance as eye and displays take it, so that differences weigh alike: the square root up to
/// white, and a half for each factor e beyond.
inline float displayed(float radiance) {
    if (!(radiance > 0.0f)) return 0.0f;
    return radiance < 1.0f ? std::sqrt(radiance) : 1.0f + 0.5f * std::log(radiance);
}

}  // namespace granita
