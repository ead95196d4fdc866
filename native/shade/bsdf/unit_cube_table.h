// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "math/saturate.h"

namespace granita {

/// A function of the unit cube, linear between 16 values along each side.
class UnitCubeTable {
  public:
    template <class Function>
    explicit UnitCubeTable(Function function) {
        for (int z = 0; z < kSize; ++z)
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x)
                    m_values[(z * kSize + y) * kSize + x] = function(unit(x), unit(y), unit(z));
    }
    float look_up(float x, float y, float z) const {
        const std::array<float, 3> place = {x, y, z};
        std::array<int, 3> cell{};
        std::array<float, 3> t{};
        for (int a = 0; a < 3; ++a) {
            const float p = saturate(place[a]) * (kSize - 1);
            cell[a] = std::min(static_cast<int>(p), kSize - 2);
            t[a] = p - static_cast<float>(cell[a]);
        }
        float sum = 0.0f;
        for (int corner = 0; corner < 8; ++corner) {
            float weight = 1.0f;
            std::array<int, 3> at = cell;
            for (int a = 0; a < 3; ++a) {
                const bool far = corner >> a & 1;
                at[a] += far;
                weight *= far ? t[a] : 1.0f - t[a];
            }
            sum += weight * m_values[(at[2] * kSize + at[1]) * kSize + at[0]];
        }
        return sum;
    }

  private:
    static constexpr int kSize = 16;
    static float unit(int i) { return static_cast<float>(i) / (kSize - 1); }

    std::array<float, kSize * kSize * kSize> m_values{};  ///< [z][y][x]
};

// An axis of such a table for indices of refraction above 1: sqrt(|f0|) up to 99, and for their
// inverses.

inline float ior_axis(float ior) {
    return std::sqrt(std::min(std::abs(ior - 1.0f) / (ior + 1.0f), 1.0f));
}
inline float ior_of_axis(float x) {
    return (1.0f + x * x) / (1.0f - std::min(x * x, 0.98f));
}

}  // namespace granita
