// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/depth_blocks.h"
#include "hider/sample_store.h"
#include "hider/simd_kernel.h"

namespace granita {

/// A tile while the SIMD executor works on it: padded copies of its samples, sorted inside each
/// pixel for the kernel.
class WorkingTile {
  public:
    /// `lens_x`, `lens_y`: lens radius times pixels per unit shear, multiplied into u and v;
    /// `lens_reach`: bound of the resulting |u|.
    WorkingTile(const TileSamples& samples, const Rect& pixels, Vec2f lens, float lens_reach);

    SortedBy sorted_by() const { return m_sorted_by; }
    /// By Time or Lens, of which the samples must have the coordinates; what was seen moves along.
    void sort(SortedBy by, const TileSamples& samples);
    SimdTile view();
    /// Copies what was seen to the store, in table order.
    void store(TileStore& out) const;

    std::vector<Fragment> fragments;  ///< sample in this tile's order
    DepthBlocks blocks;

  private:
    void copy(const std::vector<float>& from, float factor, std::vector<float>& to) const;
    void order_by(const std::vector<int>& cell);

    int m_samples;
    Rect m_pixels;
    Vec2f m_lens;
    float m_lens_reach;
    SortedBy m_sorted_by = SortedBy::Table;
    std::vector<float> m_x, m_y, m_t, m_u, m_v, m_key;
    std::vector<SurfaceId> m_id;
    std::vector<std::uint32_t> m_order;  ///< place here -> index in the table
    std::vector<std::uint32_t> m_cell_start;
    int m_cells = 0;
};

}  // namespace granita
