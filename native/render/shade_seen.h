// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hider/hider.h"
#include "render/frame.h"

namespace granita {

/// Shades those of the grids that are seen [grids], on all threads that have nothing else to do.
void shade_grids(const Frame& frame, const HiddenGrids& grids, const std::vector<bool>& seen);

/// Shades the grids that some sample sees, once the hider has finished; `grids` are its pool's.
/// Returns which they are, by slot: others belong to the buckets that see them, whose threads may
/// be shading them now.
std::vector<bool> shade_seen(Frame& frame, const Hider& hider, const HiddenGrids& grids);

}  // namespace granita
