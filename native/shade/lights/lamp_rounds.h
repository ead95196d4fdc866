// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps light a grid in two rounds: all of them by a quarter of their samples, then those whose
// noise would be seen by the others.
#pragma once

#include <cstdint>
#include <vector>

#include "shade/lights/lamp_sight.h"
#include "shade/lights/lit_grid.h"

namespace granita {

/// What a lamp gives to a grid's points.
struct LampRound {
    LampRound(std::uint32_t lamp, const LitGrid& grid, bool is_told);

    /// Has the grid's sums stand for this lamp's, and then again for their own.
    void swap(LitGrid& grid);
    void add_to(LitGrid& grid) const;

    std::vector<Vec3f> radiance;  ///< [points], each sample one of all
    std::vector<float> balance;   ///< as LitGrid's
    ReflectionParts parts;        ///< empty where not asked for
    std::vector<float> times;     ///< [points] all samples over those taken
    LampSight sight;
    bool sight_is_told;
    bool goes_on = false;  ///< to the second round
};

/// Sets goes_on for the noisiest until what the others leave is less than `unseen`
/// (math/displayed.h), beside the light of all.
void choose_to_go_on(std::vector<LampRound>& rounds, float unseen);

}  // namespace granita
