// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/sheen_table.h"

#include <algorithm>

#include "math/saturate.h"

namespace granita {

SheenFit sheen_fit(float cosine, float roughness) {
    constexpr int kSide = kSheenTableSide, kLast = kSide - 1;
    const float x = saturate(cosine) * kLast, y = std::max(saturate(roughness), 1e-3f) * kLast;
    const int column = std::min(static_cast<int>(x), kLast - 1),
              row = std::min(static_cast<int>(y), kLast - 1);
    const float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
    const auto read = [&](int plane) {
        const float* place = &kSheenTable[(plane * kSide + row) * kSide + column];
        const float low = place[0] + u * (place[1] - place[0]);
        const float high = place[kSide] + u * (place[kSide + 1] - place[kSide]);
        return low + v * (high - low);
    };
    return {read(0), read(1), read(2)};
}

}  // namespace granita
