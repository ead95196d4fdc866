// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "hider/samples/sample_table.h"

namespace granita {

/// What the samples of a tile give to the square of pixels that they reach: sums of weight times
/// what is weighed, a plane each, row by row from the lower left.
struct TileSums {
    enum Plane { kRed, kGreen, kBlue, kAlpha, kWeight, kPlanes };
    static constexpr int kPadding = 16;  ///< rows are written in whole vectors

    TileSums() = default;
    TileSums(int pixels_each_side, std::size_t channel_width)
        : each_side(pixels_each_side),
          side(kTileSize + 2 * pixels_each_side),
          width(channel_width),
          planes(pixels() * kPlanes, 0.0f),
          rows(width > 0 ? pixels() * width + kPadding : 0, 0.0f) {}

    std::size_t pixels() const { return static_cast<std::size_t>(side) * side; }
    float* plane(int which) { return planes.data() + pixels() * which; }
    const float* plane(int which) const { return planes.data() + pixels() * which; }

    int each_side = 0;          ///< pixels beyond the tile
    int side = 0;               ///< of the square
    std::size_t width = 0;      ///< ChannelSet::sample_width()
    std::vector<float> planes;  ///< [kPlanes][side][side]
    std::vector<float> rows;    ///< [side][side][width], kPadding; channels
};

}  // namespace granita
