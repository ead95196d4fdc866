// SPDX-License-Identifier: GPL-3.0-or-later
// What the hider has seen: for each sample its nearest opaque surface and its transparent fragments
// (decision 7). One layout for all executors; compositing and resolve read nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dice/grid.h"
#include "hider/fragment_lists.h"
#include "math/bounds.h"

namespace granita {

/// What is known of a micropolygon's opacity without asking where on it.
struct OpacityBounds {
    float least = 0.0f;  ///< no channel of any point has less
    float most = 1.0f;   ///< the mean of the channels has nowhere more
};

/// The grids that one bucket has hidden.  Ids follow arrival, so ties and sorting never compare ids
/// themselves but what they stand for: `before` (decision 3).
class GridPool {
  public:
    struct Place {
        const Grid* grid;
        std::uint32_t slot;  ///< index in arrival order
        int micropolygon;
    };
    /// The id of the grid's micropolygon 0.  The grid must outlive what is asked of it, but not the
    /// pool: of a picture that is kept, grids that no sample sees are gone.
    SurfaceId add(const Grid& grid);
    Place locate(SurfaceId id) const;
    /// Place::slot alone.
    std::uint32_t slot(SurfaceId id) const {
        std::uint32_t slot = m_pages[id / kPage];
        while (slot + 1 < m_bases.size() && m_bases[slot + 1] <= id) ++slot;
        return slot;
    }
    /// Whether a wins a tie against b: smaller (GridKey, micropolygon index).
    bool before(SurfaceId a, SurfaceId b) const;
    /// Of the grid that was added last; grids without transparent micropolygons have none.
    void set_opacity(std::span<const OpacityBounds> bounds);
    const OpacityBounds& opacity(SurfaceId transparent) const { return m_opacity[transparent]; }
    std::size_t size() const { return m_grids.size(); }
    /// Ids are less than this.
    SurfaceId id_end() const { return m_id_end; }
    const Grid& grid(std::uint32_t slot) const { return *m_grids[slot]; }
    /// The id of its micropolygon 0.
    SurfaceId base(std::uint32_t slot) const { return m_bases[slot]; }

  private:
    std::vector<const Grid*> m_grids;
    std::vector<SurfaceId> m_bases;
    SurfaceId m_id_end = 0;
    /// Every sample asks, so there is no search: the grid of each kPage-th id.
    static constexpr SurfaceId kPage = 8;
    std::vector<std::uint32_t> m_pages;
    std::vector<OpacityBounds> m_opacity;  ///< by id, up to the last transparent grid
};

/// The samples of one tile.  Sample index as in TileSamples.
struct TileStore {
    Vec2i tile{0, 0};  ///< tile coordinates: pixel / 16 rounded down, may be negative
    std::vector<float>
        key;  ///< [256 * samples] depth key of the nearest opaque surface; where id is kNoSurface
              ///< the key behind which nothing counts, -inf = everything does
    std::vector<SurfaceId> id;  ///< [256 * samples] or kNoSurface
    FragmentLists lists;        ///< what is nearer than `key`, nearest first, ties by `before`
};

/// A composited sample, premultiplied.
struct SampleColor {
    Vec3f color{0.0f};
    float alpha = 0.0f;
    float depth = 0.0f;  ///< camera z of the nearest surface, metres; infinity = none
};

/// The composited samples of a tile, structure of arrays: the film sums whole vectors of them.
struct SampleColors {
    std::vector<float> red, green, blue, alpha, depth;

    SampleColors() = default;
    explicit SampleColors(std::size_t count) { resize(count); }
    std::size_t size() const { return red.size(); }
    void resize(std::size_t count) {
        for (auto* plane : {&red, &green, &blue, &alpha, &depth}) plane->resize(count);
    }
    SampleColor operator[](std::size_t i) const {
        return {{red[i], green[i], blue[i]}, alpha[i], depth[i]};
    }
    void set(std::size_t i, const SampleColor& c) {
        red[i] = c.color.x;
        green[i] = c.color.y;
        blue[i] = c.color.z;
        alpha[i] = c.alpha;
        depth[i] = c.depth;
    }
};

}  // namespace granita
