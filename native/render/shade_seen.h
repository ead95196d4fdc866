// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hider/hider.h"
#include "render/frame.h"

namespace granita {

/// Shades those of the grids that are seen [grids], on all threads that have nothing else to do.
/// @param around [grids] those that tell each something (NeighbourGrids); empty: they are looked
/// for.
void shade_grids(Frame& frame, int bucket, const HiddenGrids& grids, const std::vector<bool>& seen,
                 const std::vector<HiddenGrids>& around = {});

/// Shades the grids that some sample sees, once the hider has finished; `grids` are its pool's.
/// Returns which they are, by slot: others belong to the buckets that see them, whose threads may
/// be shading them now.
/// @param around filled as shade_grids() wants it, for whoever shades them again.
std::vector<bool> shade_seen(Frame& frame, int bucket, const Hider& hider, const HiddenGrids& grids,
                             std::vector<HiddenGrids>* around = nullptr);

}  // namespace granita
