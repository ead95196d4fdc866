// SPDX-License-Identifier: GPL-3.0-or-later
// Shading where samples are, once the corners of micropolygons are shaded (render/shade_seen.h) and
// have told where that is not enough: edges of shadows, textures and cut-outs, highlights.  What is
// smooth costs nothing here, and what is not converges with the samples, in space, in time and over
// lamps.
#pragma once

#include <span>
#include <vector>

#include "hider/resolve/refined_samples.h"
#include "render/layer_choice.h"
#include "render/shade_seen.h"
#include "scene/channels.h"

namespace granita {

/// The samples of a bucket's tiles that see micropolygons which are not settled, behind their lists
/// or in them: as far into a list as anything of it is seen.  Of layers that only samples shade
/// each of these takes one in the mean (LayerChoice), and the one that passes of the first surface
/// show.
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
        std::size_t list;  ///< in m_open, of layers
        RefinedPoint point;
        float weight = 1.0f;  ///< of its light
    };
    /// A list, as far as it is known how much is seen behind its first `next` layers.
    struct OpenList {
        std::uint32_t tile, slot, next;
        LayerChoice choice;
        Vec3f transmission{1.0f};
        bool has_first = false;  ///< is past the layer that passes of the first surface show
    };
    bool is_unsettled(SurfaceId id) const;
    bool moves(SurfaceId id) const { return m_pool.grid(m_pool.slot(id)).motion; }
    void want(SurfaceId id, std::uint32_t tile, std::uint32_t sample, std::size_t list,
              const SurfacePoint& at);
    void find_behind(std::uint32_t tile);
    void find_lists(std::uint32_t tile);
    bool find_layer(std::size_t list);
    float weight_of(OpenList& list, const Vec3f& opacity) const;
    bool is_left(const Grid& grid) const { return m_frame.shading.leaves_to_samples(grid); }
    void weigh(Grid& grid, int vertex, float weight) const;
    void find_times(std::uint32_t tile);
    std::vector<Grid> shade();
    void keep_behind();
    void keep_layers();

    /// When the samples of a tile see what they see.
    struct TileTimes {
        bool known = false;
        std::vector<float> of_samples;      ///< empty: nothing of the tile moves
        std::vector<std::uint8_t> matters;  ///< [pixels] whether anything seen there moves
    };

    Frame& m_frame;
    const Hider& m_hider;
    const GridPool& m_pool;
    const std::vector<TileStore>& m_stores;
    const ChannelSet& m_channels;
    bool m_shows_first;                     ///< some of them are of the first surface
    SobolPoints m_starts;                   ///< of lists' choices
    std::vector<std::uint8_t> m_unsettled;  ///< [slots] has any such micropolygon
    std::vector<TileTimes> m_times;         ///< [tiles]
    std::vector<Wanted> m_wanted;           ///< by grid, once they are shaded
    std::vector<OpenList> m_open;
    std::vector<std::vector<Grid>> m_shaded;
    std::vector<RefinedSamples> m_tiles;
};

}  // namespace granita
