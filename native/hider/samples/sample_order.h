// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/samples/sample_table.h"
#include "math/bounds.h"

namespace granita {

/// Samples that the kernel looks at together, whatever the width of the machine's vectors.
inline constexpr int kPacket = 16;

/// Square blocks of the raster.  Where something is swept by motion or lens, the samples of a block
/// are stratified by strata of time, those by strata of the lens coordinate u, those by strata of
/// v.
struct OrderShape {
    bool stratified = false;
    int side_log2 = 0;  ///< the side of a block is 2^side_log2 pixels; negative: part of a pixel
    int times = 1, us = 1, vs = 1;

    float side() const;
    bool operator==(const OrderShape&) const = default;
};

/// How far a micropolygon goes, pixels: by motion from the shutter's opening to its closing, and by
/// the lens from one rim to the other.
struct Sweep {
    Vec2f motion{0.0f}, lens{0.0f};

    bool still() const { return motion == Vec2f(0.0f) && lens == Vec2f(0.0f); }
};

/// What a micropolygon about as large as a pixel costs in this order, relative to other orders of
/// as many samples a pixel.
double order_cost(const OrderShape& shape, int samples, const Sweep& sweep);
/// The cheapest shape.
OrderShape best_order(int samples, const Sweep& sweep);

/// The place of a tile's samples in memory.
///
/// Where nothing is swept, [block][samples of the block]: packets of kPacket samples are neighbours
/// in place, seen or missed together.  Where the table is made of such packets it is the order
/// itself, and nothing is moved: then only packets() tells the blocks.
///
/// Stratified, [stratum][block]: a stratum stands for a stratum of time and lens and has one sample
/// in every block, so that the samples which look where and when a micropolygon is lie in a small
/// window of the stratum's blocks.  The (0, m, s) nets of the table make strata exact.
class SampleOrder {
  public:
    static constexpr std::uint32_t kNone = ~0u;  ///< a slot without sample

    /// `pixels`: those that count; other samples get no slot.
    void arrange(const TileSamples& samples, const Rect& pixels, const OrderShape& shape);

    const OrderShape& shape() const { return m_shape; }
    int blocks_wide() const { return m_blocks_wide; }  ///< a tile has as many rows of blocks
    /// Slots from one stratum to the next: its blocks, and a packet of empty slots, since a block's
    /// slots would else lie a power of two apart and share few sets of the cache.
    std::size_t stratum_stride() const {
        return static_cast<std::size_t>(m_blocks_wide) * m_blocks_wide + kPacket;
    }
    /// Slots of a block; a multiple of kPacket unless stratified.
    int strata() const { return m_strata; }
    std::size_t slots() const { return m_slots; }
    bool is_table() const { return m_is_table; }
    /// Index in the table of each slot; empty where they are the same.
    const std::vector<std::uint32_t>& table_index() const { return m_table_index; }
    std::uint32_t index(std::size_t slot) const {
        return m_is_table ? static_cast<std::uint32_t>(slot) : m_table_index[slot];
    }
    /// [block][packet of the block]: first slot / kPacket; unless stratified.
    const std::vector<std::uint32_t>& packets() const { return m_packets; }

  private:
    void distribute(const TileSamples& samples, const Rect& pixels);
    bool take_table(const TileSamples& samples, const Rect& pixels);
    void number_packets();
    /// Where the samples are a net, every stratum of a block has as many: no sort.  False
    /// otherwise.
    bool place_net(const TileSamples& samples, const Rect& pixels);
    void sort_block(const TileSamples& samples, std::uint32_t* slots, std::size_t count);

    OrderShape m_shape;
    int m_blocks_wide = 0, m_strata = 0;
    std::size_t m_slots = 0;
    bool m_is_table = false;
    std::vector<std::uint32_t> m_table_index, m_packets, m_scratch;
};

}  // namespace granita
