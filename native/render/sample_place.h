// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hider/samples/sample_table.h"
#include "math/sampling.h"

namespace granita {

/// In the sample sequences of the frame: pixels along Morton's curve, whose aligned squares are
/// stratified as one.
inline std::uint32_t place_of(Vec2i tile, std::uint32_t sample, int samples) {
    const std::uint32_t pixel = sample / static_cast<std::uint32_t>(samples);
    const auto x = static_cast<std::uint32_t>(tile.x * kTileSize) + pixel % kTileSize;
    const auto y = static_cast<std::uint32_t>(tile.y * kTileSize) + pixel / kTileSize;
    return morton_index(x, y) * static_cast<std::uint32_t>(samples) +
           sample % static_cast<std::uint32_t>(samples);
}

}  // namespace granita
