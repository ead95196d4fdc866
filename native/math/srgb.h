// SPDX-License-Identifier: GPL-3.0-or-later
// The curve of sRGB (IEC 61966-2-1), as Cycles computes it: nothing below zero.
#pragma once

#include <cmath>

namespace granita {

inline float linear_from_srgb(float x) {
    if (x < 0.04045f) return x < 0.0f ? 0.0f : x / 12.92f;
    return std::pow((x + 0.055f) / 1.055f, 2.4f);
}
/// Its derivative.
inline double linear_from_srgb_slope(double x) {
    if (x < 0.04045) return x < 0.0 ? 0.0 : 1.0 / 12.92;
    return 2.4 / 1.055 * std::pow((x + 0.055) / 1.055, 1.4);
}

}  // namespace granita
