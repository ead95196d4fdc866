// SPDX-License-Identifier: GPL-3.0-or-later
// Guarded operations that nodes share: undefined results are zero, as in
// Cycles.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/saturate.h"

namespace granita {

inline float safe_divide(float a, float b) {
    return b != 0.0f ? a / b : 0.0f;
}

inline float safe_modulo(float a, float b) {
    return b != 0.0f ? std::fmod(a, b) : 0.0f;
}

inline float safe_power(float a, float b) {
    if (a < 0.0f && b != std::trunc(b)) return 0.0f;
    return std::pow(a, b);
}

inline float wrap(float value, float high, float low) {
    const float range = high - low;
    return range != 0.0f ? value - range * std::floor((value - low) / range) : low;
}

inline float ping_pong(float value, float scale, float) {
    if (scale == 0.0f) return 0.0f;
    const float place = (value - scale) / (scale * 2.0f);
    return std::abs((place - std::floor(place)) * scale * 2.0f - scale);
}

/// The polynomial smooth minimum of third degree (Quilez).
inline float smooth_minimum(float a, float b, float distance) {
    if (distance == 0.0f) return std::min(a, b);
    const float h = std::max(distance - std::abs(a - b), 0.0f) / distance;
    return std::min(a, b) - h * h * h * distance * (1.0f / 6.0f);
}

}  // namespace granita
