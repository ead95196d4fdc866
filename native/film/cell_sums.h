// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "film/film.h"

namespace granita {

/// The weights of a pixel sum to about 1.  What is far below says nothing of the pixel: filters
/// much narrower than the samples' spacing may find none, and negative lobes under few samples may
/// nearly cancel.
constexpr float kLeastWeight = 1.0f / 16;

/// What the tiles around a cell of the film have given to its pixels; ratios once divided by the
/// weight.
struct Film::CellSums {
    std::vector<float> planes;    ///< [TileSums::kPlanes][pixels]
    std::vector<float> channels;  ///< [pixels][ChannelSet::sample_width()]
    std::vector<float> center;    ///< [pixels][ChannelSet::center_width()]
};

}  // namespace granita
