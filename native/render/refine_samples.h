// SPDX-License-Identifier: GPL-3.0-or-later
// Shading where samples are, once the corners of micropolygons are shaded (render/shade_seen.h) and
// have told where that is not enough: edges of shadows and textures, highlights.  What is
// smooth costs nothing here, and what is not converges with the samples, in space, in time and over
// lamps.
#pragma once

#include <span>
#include <vector>

#include "hider/resolve/refined_samples.h"
#include "render/shade_seen.h"

namespace granita {

/// The samples of a bucket's tiles that see micropolygons which are not settled.
class BucketRefinement {
  public:
    /// `seen`: of shade_seen(); all of those are shaded.
    BucketRefinement(Frame& frame, const Hider& hider, const std::vector<TileStore>& stores,
                     const std::vector<bool>& seen);
    const RefinedSamples& tile(std::size_t index) const { return m_tiles[index]; }

  private:
    struct Wanted {
        std::uint32_t slot;  ///< of the grid
        std::uint32_t tile, sample;
        RefinedPoint point;
    };
    bool any_moves(std::span<const SurfaceId> ids) const;
    bool any_moves(const FragmentLists& lists) const;
    void find(const TileStore& store, const TileSamples& samples, std::uint32_t tile);
    void shade();

    Frame& m_frame;
    const GridPool& m_pool;
    std::vector<std::uint8_t> m_unsettled;  ///< [slots] has any such micropolygon
    std::vector<Wanted> m_wanted;
    std::vector<Grid> m_shaded;
    std::vector<RefinedSamples> m_tiles;
};

}  // namespace granita
