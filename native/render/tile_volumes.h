// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "hider/resolve/composite.h"
#include "render/frame.h"

namespace granita {

/// What the volumes of a scene make of a tile's samples: between the layers of their lists, and
/// before what is behind these.
struct TileVolumes {
    /// Whose grids are shaded.  `shows`: as tile_background()'s, of where the film shows it.
    TileVolumes(Frame& frame, const SampleTable& table, const TileStore& store,
                const GridPool& pool, const RefinedSamples& refined,
                const std::function<bool(SurfaceId)>& shows);

    RefinedSamples refined;  ///< and what is seen of layers through volumes
    SampleVolumes samples;
};

/// Whether what this takes of one tile after the other has room beside the lists of them all
/// (HiderFrame::list_bytes).
bool volumes_fit(const Frame& frame, const std::vector<TileStore>& stores);

}  // namespace granita
