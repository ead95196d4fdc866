// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/sample_table.h"
#include "math/bounds.h"

namespace granita {

/// Samples that the kernel looks at together, whatever the width of the machine's vectors.
inline constexpr int kPacket = 16;

/// Square blocks of the raster; the samples of a block sorted into strata of time, those into
/// strata of the lens coordinate u, those into strata of v.
struct OrderShape {
    int side_log2 = 0;  ///< the side of a block is 2^side_log2 pixels; negative: part of a pixel
    int times = 1, us = 1, vs = 1;

    float side() const;
    bool operator==(const OrderShape&) const = default;
};

/// How far a micropolygon goes, pixels: by motion from the shutter's opening to its closing, and by
/// the lens from one rim to the other.
struct Sweep {
    Vec2f motion{0.0f}, lens{0.0f};
};

/// Packets that a micropolygon about as large as a pixel has to be tested against.
double packets_met(const OrderShape& shape, int samples, const Sweep& sweep);
/// The shape that meets fewest, for `samples` a pixel.
OrderShape best_order(int samples, const Sweep& sweep);

/// The place of a tile's samples in memory, packets of neighbours in place, time and lens: what
/// sits in one packet of kPacket is seen or missed together, so that nearly all tests hit.  The
/// (0, m, s) nets of the table make the strata exact.
class SampleOrder {
  public:
    static constexpr std::uint32_t kNone = ~0u;  ///< a slot without sample

    SampleOrder() = default;
    /// `pixels`: those that count; other samples get no slot.
    SampleOrder(const TileSamples& samples, const Rect& pixels, const OrderShape& shape);

    const OrderShape& shape() const { return m_shape; }
    int blocks_wide() const { return m_blocks_wide; }  ///< a tile has as many rows of blocks
    int packets() const { return m_packets; }          ///< a block
    std::size_t slots() const { return m_table_index.size(); }
    /// [block][packet][kPacket] index in the table.
    const std::vector<std::uint32_t>& table_index() const { return m_table_index; }

  private:
    void distribute(const TileSamples& samples, const Rect& pixels);
    void sort_block(const TileSamples& samples, std::uint32_t* slots, std::size_t count);

    OrderShape m_shape;
    int m_blocks_wide = 0, m_packets = 0;
    std::vector<std::uint32_t> m_table_index;
    std::vector<std::uint32_t> m_scratch;
};

}  // namespace granita
