// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "hider/sample_table.h"
#include "math/bounds.h"

namespace granita {

/// Hierarchical depth of one tile (Greene, Kass and Miller 1993): for each block of 4 x 4 pixels
/// the farthest key of all its samples, over all times and lens points, hence conservative for
/// anything whose swept bounds lie in the blocks.  It may lag behind: keys only come nearer, so an
/// old value only culls less.
class DepthBlocks {
  public:
    /// `pixels`: the tile's pixels that count; others never hide nor show anything.
    explicit DepthBlocks(const Rect& pixels);

    /// `written` more samples have come nearer.
    void note_writes(std::uint64_t written) { m_writes += written; }
    /// Brings the blocks up to date when enough samples changed to make it worth while.
    void update(const float* keys, int samples);
    /// Whether everything in these pixels (relative to the tile) is nearer than `nearest_key`.
    bool hide(const Rect& pixels, float nearest_key) const;

  private:
    static constexpr int kSide = 4, kBlocks = kTileSize / kSide;
    Rect m_pixels;
    std::uint64_t m_writes = 0;
    std::array<float, kBlocks * kBlocks> m_farthest;
};

}  // namespace granita
