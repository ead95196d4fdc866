// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/sample_channels.h"

#include <cmath>

namespace granita {

CenterSamples center_samples(const TileSamples& samples) {
    CenterSamples nearest{};
    const auto n = static_cast<std::uint32_t>(samples.samples);
    for (int pixel = 0; pixel < kTileSize * kTileSize; ++pixel) {
        const int row = pixel / kTileSize, column = pixel % kTileSize;
        const float x = static_cast<float>(column) + 0.5f;
        const float y = static_cast<float>(row) + 0.5f;
        const std::uint32_t first = static_cast<std::uint32_t>(pixel) * n;
        nearest[pixel] = first;
        float least = INFINITY;
        for (std::uint32_t i = first; i < first + n; ++i) {
            const float dx = samples.x[i] - x, dy = samples.y[i] - y;
            if (dx * dx + dy * dy < least) {
                least = dx * dx + dy * dy;
                nearest[pixel] = i;
            }
        }
    }
    return nearest;
}

}  // namespace granita
