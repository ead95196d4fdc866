// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

namespace granita {

class SampleOrder;

/// *Bounds of a time stratum*: when and from which lens points the samples of a stratum look, over
/// all blocks of a tile: the table stratifies all blocks alike, so one set of bounds is nearly as
/// tight as one a block, and a micropolygon is bounded once for all blocks.  Of a stratified order.
struct StratumBounds {
    /// [strata], and spare elements for whole vectors; lo > hi where there is no sample.
    std::vector<float> t_lo, t_hi, u_lo, u_hi, v_lo, v_hi;
    /// Of 1 / focus distance, where the lens refocuses.
    std::vector<float> focus_lo, focus_hi;

    static constexpr int kSlabs = 64;
    /// Strata with times in slab s of kSlabs of the shutter are among [first[s], end[s]).
    std::array<int, kSlabs> first{}, end{};
};

/// `t`, `u`, `v`, `inverse_focus`: [slots] of the order, NaN without sample; may be empty: then t
/// is the whole shutter, the lens a point and the focus not bounded.
StratumBounds bound_strata(const SampleOrder& order, const std::vector<float>& t,
                           const std::vector<float>& u, const std::vector<float>& v,
                           const std::vector<float>& inverse_focus);

}  // namespace granita
