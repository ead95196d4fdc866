// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/depth_blocks.h"
#include "hider/sample_store.h"
#include "hider/simd_kernel.h"

namespace granita {

/// A tile while the SIMD executor works on it: padded copies of its samples, in table order until
/// the tile has motion and then sorted by time inside each pixel.
class WorkingTile {
  public:
    /// `lens_x`, `lens_y`: lens radius times pixels per unit shear, multiplied into u and v.
    WorkingTile(const TileSamples& samples, const Rect& pixels, float lens_x, float lens_y);

    bool sorted() const { return !m_order.empty(); }
    /// From here on with times; what was seen so far moves along.
    void sort_by_time(const TileSamples& samples, float lens_x, float lens_y);
    SimdTile view();
    /// Copies what was seen to the store, in table order.
    void store(TileStore& out) const;

    std::vector<Fragment> fragments;  ///< sample in this tile's order
    DepthBlocks blocks;

  private:
    void copy(const std::vector<float>& from, float factor, std::vector<float>& to) const;

    int m_samples;
    Rect m_pixels;
    std::vector<float> m_x, m_y, m_t, m_u, m_v, m_key;
    std::vector<SurfaceId> m_id;
    std::vector<std::uint32_t> m_order;  ///< place here -> index in the table; empty = the same
    std::vector<std::uint32_t> m_time_start;
    int m_time_cells = 0;
};

}  // namespace granita
