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

/// The samples of a bucket's tiles that see micropolygons which are not settled, behind their lists
/// or in them.
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
        std::uint32_t list, layer;  ///< slot of its list; kBehind: it is behind the list
        RefinedPoint point;
    };
    static constexpr std::uint32_t kBehind = ~0u;
    bool any_moves(std::span<const SurfaceId> ids) const;
    bool any_moves(const FragmentLists& lists) const;
    bool is_unsettled(SurfaceId id) const;
    void find(const TileStore& store, const TileSamples& samples, std::uint32_t tile);
    void set_times(const TileStore& store, const TileSamples& samples, std::size_t first);
    void shade();
    void keep(const Wanted& wanted, const Grid& shaded, int vertex);

    Frame& m_frame;
    const GridPool& m_pool;
    const std::vector<TileStore>& m_stores;
    std::vector<std::uint8_t> m_unsettled;  ///< [slots] has any such micropolygon
    std::vector<Wanted> m_wanted;
    std::vector<Grid> m_shaded;
    std::vector<RefinedSamples> m_tiles;
};

}  // namespace granita
