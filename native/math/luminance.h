// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// Of the primaries of Rec. 709, as Cycles has them.
inline constexpr Vec3f kLuminance(0.2126729f, 0.7151522f, 0.0721750f);

/// Of a linear colour of Rec. 709.
template <class T>
T luminance_of(const T& red, const T& green, const T& blue) {
    return kLuminance.x * red + kLuminance.y * green + kLuminance.z * blue;
}

inline float luminance(const Vec3f& c) {
    return luminance_of(c.x, c.y, c.z);
}

/// Mean of the channels' sizes.
inline float mean_size(const Vec3f& c) {
    return (std::abs(c.x) + std::abs(c.y) + std::abs(c.z)) / 3.0f;
}

}  // namespace granita
