// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hider/hider.h"
#include "hider/micropolygon.h"

namespace granita {

/// The tiles of one bucket with their samples and what was seen, as the CPU executors share them.
/// A tile's t is made when the first moving grid meets the tile; u and v where the camera has a
/// lens.
class BucketTiles {
  public:
    BucketTiles(const HiderFrame& frame, const Rect& tiles, const Rect& pixels);
    ~BucketTiles();
    BucketTiles(const BucketTiles&) = delete;
    BucketTiles& operator=(const BucketTiles&) = delete;

    std::size_t count() const { return m_stores.size(); }
    /// Tiles whose pixels the bounds may touch.
    Rect touched(const RasterBounds& bounds) const;
    std::size_t index(int tile_x, int tile_y) const {
        return static_cast<std::size_t>(tile_y - m_tiles.y0) * m_tiles.width() + tile_x -
               m_tiles.x0;
    }
    Vec2i tile(std::size_t i) const { return m_stores[i].tile; }
    Vec2d origin(std::size_t i) const { return Vec2d(m_stores[i].tile * kTileSize); }
    /// The pixels of the tile that count, relative to its corner.
    Rect local_pixels(std::size_t i) const;

    bool has_time(std::size_t i) const { return m_needs[i].time; }
    /// Makes the tile's t; x, y, u, v keep their bits.
    void need_time(std::size_t i);

    TileStore& store(std::size_t i) { return m_stores[i]; }
    const TileStore& store(std::size_t i) const { return m_stores[i]; }
    TileSamples& samples(std::size_t i) { return m_samples[i]; }
    const TileSamples& samples(std::size_t i) const { return m_samples[i]; }
    std::vector<TileStore>& stores() { return m_stores; }
    const GridPool& pool() const { return m_pool; }
    GridPool& pool() { return m_pool; }

    /// Whether a surface at this depth is in front of the sample's nearest opaque one.
    bool wins(float key, SurfaceId id, float stored_key, SurfaceId stored_id) const {
        return key > stored_key ||
               (key == stored_key && stored_id != kNoSurface && m_pool.before(id, stored_id));
    }
    /// Drops the fragments that ended up behind the sample's opaque surface.
    void drop_hidden_fragments(std::size_t i);
    /// Throws Cancelled; called between tiles, whose samples may be millions.
    void check_cancelled() const;
    /// Counts and reports micropolygons left out of the grid.
    void report_dropped(const Grid& grid, std::uint64_t dropped) const;

  private:
    const HiderFrame& m_frame;
    Rect m_tiles, m_pixels;
    GridPool m_pool;
    std::vector<TileStore> m_stores;
    std::vector<TileSamples> m_samples;
    std::vector<SampleNeeds> m_needs;
};

/// Depth keys that the clip range admits, and the kind of key.
DepthRange depth_range(const Projection& projection);

}  // namespace granita
