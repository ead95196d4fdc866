// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/samples/sample_order.h"
#include "hider/simd/stratum_bounds.h"
#include "math/bounds.h"

namespace granita {

/// Hierarchical depth of one tile (Greene, Kass and Miller 1993) in slabs of time (Boulos et al.
/// 2010): the farthest key of each block of the raster and of the tile; where the order of samples
/// is stratified, of each stratum, whose times are a slab, in squares of four pixels; where it is
/// not, of each packet.  It may lag behind: keys only come nearer, so an old value only culls less.
class DepthBlocks {
  public:
    /// Nothing seen.  The order and the bounds of its strata must outlive the object.
    void reset(const SampleOrder& order, const StratumBounds& bounds);

    /// `written` more samples have come nearer.
    void note_writes(std::uint64_t written) { m_writes += written; }
    /// Rebuilds when enough samples changed to make it worth while.
    void update(const float* keys);
    void rebuild(const float* keys);
    bool lags() const { return m_writes > 0; }
    /// Whether all samples of these pixels of the tile with times in [time0, time1] are nearer than
    /// `nearest_key`.
    bool hide(const Rect& pixels, float time0, float time1, float nearest_key) const;
    /// Whether any rebuild has happened since reset().
    bool filled() const { return m_filled; }
    /// [slot / kPacket]; not of a stratified order.
    const float* farthest_of_packets() const { return m_packet.data(); }
    /// [square][stratum], squares row by row, 2^square_shift() blocks a side; of a stratified
    /// order.
    const float* farthest_of_strata() const { return m_stratum.data(); }
    int square_shift() const { return m_square_shift; }
    int squares_wide() const { return m_blocks_wide >> m_square_shift; }
    /// Nothing nearer than this is hidden by farthest_of_strata().
    float nearest_of_strata() const { return m_nearest_stratum; }

  private:
    void rebuild_packets(const float* keys);
    void rebuild_strata(const float* keys);
    bool hide_in_square(std::size_t square, float time0, float time1, float limit) const;

    const StratumBounds* m_bounds = nullptr;
    const std::vector<std::uint32_t>* m_packets = nullptr;
    int m_blocks_wide = 0, m_strata = 0, m_square_shift = 0;
    std::size_t m_stratum_stride = 0;
    bool m_stratified = false;
    std::uint64_t m_writes = 0;
    std::vector<float> m_packet, m_block, m_stratum;
    float m_tile = 0.0f, m_nearest_stratum = 0.0f;
    bool m_filled = false;
};

}  // namespace granita
