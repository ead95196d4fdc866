// SPDX-License-Identifier: GPL-3.0-or-later
// Grids beside a grid, of the same surface: what they gather of other surfaces' light they tell
// each other (shade/told_light.h), or each would end in a step of its noise.
#pragma once

#include "render/frame.h"

namespace granita {

/// Pixels around a bucket in which grids may lie that tell grids of the bucket something.
int neighbour_margin(const Options& options);

/// Those that may tell a grid that a bucket sees, in the order of their keys: the same whichever
/// bucket asks, and whatever is seen of them.
HiddenGrids neighbours_of(Frame& frame, int bucket, SharedGrid& grid);

/// [grids] the same of all that are `seen`; empty where nobody asks.
std::vector<HiddenGrids> all_neighbours(Frame& frame, int bucket, const HiddenGrids& grids,
                                        const std::vector<bool>& seen);

}  // namespace granita
