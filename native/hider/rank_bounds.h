// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

namespace granita {

class SampleOrder;
struct TileSamples;

/// Where, when and from which lens points the samples of a rank look, over all blocks of a tile:
/// the table stratifies all blocks alike, so one set of bounds is nearly as tight as one a block,
/// and a micropolygon is bounded once for all blocks.  Of a ranked order.
struct RankBounds {
    /// [ranks], and spare elements for whole vectors.  x, y: from the block's corner, pixels.
    std::vector<float> x_lo, x_hi, y_lo, y_hi, t_lo, t_hi, u_lo, u_hi, v_lo, v_hi;

    static constexpr int kSlabs = 64;
    /// Ranks with times in slab s of kSlabs of the shutter are among [first[s], end[s]).
    std::array<int, kSlabs> first{}, end{};
};

/// `x`, `y`, `t`, `u`, `v`: [slots] of the order, NaN without sample; t, u, v may be empty.
RankBounds bound_ranks(const SampleOrder& order, const std::vector<float>& x,
                       const std::vector<float>& y, const std::vector<float>& t,
                       const std::vector<float>& u, const std::vector<float>& v);

}  // namespace granita
