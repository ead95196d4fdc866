// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

#include "math/vec.h"

namespace granita {

/// Every third bit of a code, from the lowest 21 of `x`.
inline std::uint64_t spread_bits(std::uint64_t x) {
    x = (x | x << 32) & 0x001f00000000ffffull;
    x = (x | x << 16) & 0x001f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

/// Places that are close have codes that are close (Morton 1966).  Coordinates below 0 or from
/// 2^bits on are clamped; bits <= 21.
inline std::uint64_t morton_code(const Vec3f& cell, int bits) {
    const float last = static_cast<float>((1 << bits) - 1);
    std::uint64_t code = 0;
    for (int i = 0; i < 3; ++i)
        code |= spread_bits(static_cast<std::uint64_t>(std::clamp(cell[i], 0.0f, last))) << i;
    return code;
}

}  // namespace granita
