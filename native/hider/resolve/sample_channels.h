// SPDX-License-Identifier: GPL-3.0-or-later
// What the samples of a tile know beside their colour: the channels of passes (scene/channels.h).
#pragma once

#include <array>
#include <vector>

#include "hider/samples/sample_table.h"
#include "scene/channels.h"

namespace granita {

struct SampleChannels {
    /// Rows are read in whole vectors: the last is followed by so many floats.
    static constexpr int kPadding = 16;
    std::vector<float> filtered;  ///< [256 * samples][ChannelSet::sample_width()], kPadding
    std::vector<float> center;    ///< [256][ChannelSet::center_width()]
};

using CenterSamples = std::array<std::uint32_t, kTileSize * kTileSize>;

/// The index of the sample nearest to the centre of each of a tile's pixels; the first of equals.
CenterSamples center_samples(const TileSamples& samples);

}  // namespace granita
