// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "hider/sample_store.h"
#include "render/frame.h"

namespace granita {

using HiddenGrids = std::vector<std::shared_ptr<SharedGrid>>;  ///< in a hider's arrival order

/// Shades the grids that some sample sees; `grids` are those of the pool.
void shade_seen(Frame& frame, const std::vector<TileStore>& stores, const GridPool& pool,
                const HiddenGrids& grids);

}  // namespace granita
