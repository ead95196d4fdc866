// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/bounds.h"

namespace granita {

/// Bounds of time and lens point of packet k of any block of a tile.  [packets], and spare elements
/// for whole vectors.
struct PacketBounds {
    std::vector<float> t_lo, t_hi, u_lo, u_hi, v_lo, v_hi;
};

/// Hierarchical depth of one tile (Greene, Kass and Miller 1993) in slabs of time (Boulos et al.
/// 2010): the farthest key of each packet of samples, whose times are a slab; of each block of the
/// raster over all its packets; and of the tile.  It may lag behind: keys only come nearer, so an
/// old value only culls less.
class DepthBlocks {
  public:
    /// Nothing seen.  `bounds` must outlive the object.
    void reset(int blocks_wide, int packets, const PacketBounds& bounds);

    /// `written` more samples have come nearer.
    void note_writes(std::uint64_t written) { m_writes += written; }
    /// Rebuilds when enough samples changed to make it worth while.
    void update(const float* keys);
    void rebuild(const float* keys);
    /// Whether all samples of these pixels of the tile with times in [time0, time1] are nearer than
    /// `nearest_key`.
    bool hide(const Rect& pixels, float time0, float time1, float nearest_key) const;
    /// Whether any rebuild has happened since reset().
    bool filled() const { return m_filled; }
    /// [block][packet]
    const float* farthest_of_packets() const { return m_packet.data(); }

  private:
    bool hide_in_block(std::size_t block, float time0, float time1, float limit) const;

    int m_blocks_wide = 0, m_packets = 0;
    const PacketBounds* m_bounds = nullptr;
    std::uint64_t m_writes = 0;
    std::vector<float> m_packet, m_block;
    float m_tile = 0.0f;
    bool m_filled = false;
};

}  // namespace granita
