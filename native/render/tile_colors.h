// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hider/hider.h"
#include "hider/resolve/layer_table.h"
#include "hider/resolve/refined_samples.h"
#include "render/frame.h"
#include "render/resolved_tile.h"

namespace granita {

/// The composited samples of one tile after the other.
class TileColors {
  public:
    TileColors(Frame& frame, const SampleTable& table) : m_frame(frame), m_table(table) {}
    /// All samples of a tile whose grids are shaded.
    void composite(const TileStore& store, const TileSamples& samples, LayerTable& layers,
                   const RefinedSamples& refined);
    /// Takes over the samples of these pixels (relative to the tile) of the same tile.
    void take(const TileColors& part, const Rect& pixels, int samples);
    ResolvedTile resolve(Vec2i tile, const TileSamples& samples) const;

  private:
    TileContribution filter(Vec2i tile, const TileSamples& samples) const;

    Frame& m_frame;
    const SampleTable& m_table;
    SampleColors m_colors;
    SampleChannels m_channels;
};

}  // namespace granita
