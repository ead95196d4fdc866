// SPDX-License-Identifier: GPL-3.0-or-later
// What the hider has seen: for each sample its nearest opaque surface and its transparent fragments
// (decision 7). One layout for all executors; compositing and resolve read nothing else.
#pragma once

#include <cstdint>
#include <vector>

#include "dice/grid.h"
#include "math/bounds.h"

namespace granita {

/// A micropolygon of a bucket: GridPool::base of its grid plus its index in the grid.
using SurfaceId = std::uint32_t;
inline constexpr SurfaceId kNoSurface = ~SurfaceId{0};

/// The grids that one bucket has hidden.  Ids follow arrival, so ties and sorting never compare ids
/// themselves but what they stand for: `before` (decision 3).
class GridPool {
  public:
    struct Place {
        const Grid* grid;
        std::uint32_t slot;  ///< index in arrival order
        int micropolygon;
    };
    /// The id of the grid's micropolygon 0.  The grid must outlive the pool.
    SurfaceId add(const Grid& grid);
    Place locate(SurfaceId id) const;
    /// Whether a wins a tie against b: smaller (GridKey, micropolygon index).
    bool before(SurfaceId a, SurfaceId b) const;
    std::size_t size() const { return m_grids.size(); }
    /// Ids are less than this.
    SurfaceId id_end() const;
    const Grid& grid(std::uint32_t slot) const { return *m_grids[slot]; }

  private:
    std::vector<const Grid*> m_grids;
    std::vector<SurfaceId> m_bases;
    /// Every sample asks, so there is no search: the grid of each kPage-th id.
    static constexpr SurfaceId kPage = 8;
    std::vector<std::uint32_t> m_pages;
};

struct Fragment {
    float key;             ///< depth key, larger is nearer
    std::uint32_t sample;  ///< index in the tile: pixel * samples + s
    SurfaceId id;
};

/// The samples of one tile.  Sample index as in TileSamples.
struct TileStore {
    Vec2i tile{0, 0};  ///< tile coordinates: pixel / 16 rounded down, may be negative
    std::vector<float>
        key;  ///< [256 * samples] depth key of the nearest opaque surface, -inf = none
    std::vector<SurfaceId> id;        ///< [256 * samples] or kNoSurface
    std::vector<Fragment> fragments;  ///< nearer than `key`; any order until sorted by (sample, key
                                      ///< descending, before)
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
