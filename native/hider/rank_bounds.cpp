// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/rank_bounds.h"

#include <algorithm>
#include <cmath>

#include "hider/sample_order.h"

namespace granita {
namespace {

/// `corner(block)` is subtracted; values that are not numbers are left out.
template <class Corner>
void bound(const std::vector<float>& values, std::size_t ranks, std::size_t blocks, Corner corner,
           std::vector<float>& lo, std::vector<float>& hi) {
    lo.assign(ranks + kPacket, values.empty() ? 0.0f : INFINITY);
    hi.assign(ranks + kPacket, values.empty() ? 0.0f : -INFINITY);
    if (values.empty()) return;
    const float* from = values.data();
    for (std::size_t r = 0; r < ranks; ++r)
        for (std::size_t block = 0; block < blocks; ++block) {
            const float value = *from++ - corner(block);
            lo[r] = value < lo[r] ? value : lo[r];
            hi[r] = value > hi[r] ? value : hi[r];
        }
}

void find_slabs(std::size_t ranks, RankBounds& bounds) {
    for (int s = 0; s < RankBounds::kSlabs; ++s) {
        const float t0 = static_cast<float>(s) / RankBounds::kSlabs;
        const float t1 = static_cast<float>(s + 1) / RankBounds::kSlabs;
        int first = 0, end = static_cast<int>(ranks);
        while (first < end && bounds.t_hi[first] < t0) ++first;
        while (end > first && bounds.t_lo[end - 1] > t1) --end;
        bounds.first[s] = first;
        bounds.end[s] = end;
    }
}

}  // namespace

RankBounds bound_ranks(const SampleOrder& order, const std::vector<float>& x,
                       const std::vector<float>& y, const std::vector<float>& t,
                       const std::vector<float>& u, const std::vector<float>& v) {
    const auto ranks = static_cast<std::size_t>(order.ranks());
    const auto wide = static_cast<std::size_t>(order.blocks_wide());
    const float side = order.shape().side();
    const std::size_t blocks = wide * wide;
    RankBounds out;
    const auto left = [&](std::size_t b) { return static_cast<float>(b % wide) * side; };
    const auto bottom = [&](std::size_t b) { return static_cast<float>(b / wide) * side; };
    bound(x, ranks, blocks, left, out.x_lo, out.x_hi);
    bound(y, ranks, blocks, bottom, out.y_lo, out.y_hi);
    const auto none = [](std::size_t) { return 0.0f; };
    bound(t, ranks, blocks, none, out.t_lo, out.t_hi);
    bound(u, ranks, blocks, none, out.u_lo, out.u_hi);
    bound(v, ranks, blocks, none, out.v_lo, out.v_hi);
    if (t.empty()) std::fill(out.t_hi.begin(), out.t_hi.end(), 1.0f);
    find_slabs(ranks, out);
    return out;
}

}  // namespace granita
