// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hider/hider.h"
#include "hider/resolve/layer_table.h"
#include "hider/resolve/refined_samples.h"
#include "render/frame.h"

namespace granita {

/// The composited samples of one tile after the other.
class TileColors {
  public:
    explicit TileColors(Frame& frame) : m_frame(frame) {}
    /// All samples of a tile whose grids are shaded.
    void composite(const TileStore& store, const TileSamples& samples, LayerTable& table,
                   const RefinedSamples& refined);
    /// Takes over the samples of these pixels (relative to the tile) of the same tile.
    void take(const TileColors& part, const Rect& pixels, int samples);
    TileContribution filter(Vec2i tile, const TileSamples& samples) const;

  private:
    Frame& m_frame;
    SampleColors m_colors;
    SampleChannels m_channels;
};

}  // namespace granita
