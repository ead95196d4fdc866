// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shade/lights/lamp_set.h"
#include "shade/lights/lamp_turn.h"

namespace granita {

/// Dimensions of lamps by chance: those that one point has chosen hardly ever share one.
inline constexpr std::size_t kChosenDimensions = 32;

/// Of a point's sequences, by which chance takes its lobes: behind the world's, the lobes', that of
/// the choice of lamps, the lamps' and those of chosen ones.
/// @param asked_by_all lamps that no choice is made of.
inline std::size_t lobe_choice_dimension(std::size_t lobe_count, std::size_t asked_by_all) {
    return 1 + lobe_count + 1 + asked_by_all + kChosenDimensions;
}

/// Each lamp lights each point, lamp by lamp, so that their rays keep together.  `first`: dimension
/// of the first lamp; `sights`: gets those of small ones; nullptr: not asked for.
void light_by_all(const LampSet& set, LitGrid& grid, const std::vector<LitPoint>& points,
                  std::size_t first, const Progress& progress, std::vector<LampSight>* sights);

/// How the points see lamps that others have seen, in that order.
std::vector<LampSight> see_again(const LampSet& set, LitGrid& grid,
                                 const std::vector<LitPoint>& points,
                                 std::span<const LampSight> lamps, std::size_t first,
                                 const Progress& progress);

/// The lamps that points have chosen, lamp by lamp.
void light_by_chosen(const LampSet& set, LitGrid& grid, const std::vector<LitPoint>& points,
                     std::vector<LampTurn> turns, std::size_t first, const Progress& progress);

}  // namespace granita
