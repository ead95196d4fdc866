// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hider/hider.h"
#include "hider/micropolygon.h"
#include "hider/micropolygon_class.h"
#include "hider/sample_lists.h"

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
    void drop_samples();
    /// The same that were dropped.
    void make_samples();
    /// Adds the grid to the pool; counts and reports the micropolygons that are left out of it.
    SurfaceId add(const Grid& grid, const GridClasses& classes);

    /// Whether a surface at this depth is in front of the sample's nearest opaque one.
    bool wins(float key, SurfaceId id, float stored_key, SurfaceId stored_id) const {
        return key > stored_key ||
               (key == stored_key && stored_id != kNoSurface && m_pool.before(id, stored_id));
    }
    /// Of all lists of the bucket.
    Arena& list_memory() { return m_list_memory; }
    /// Notes how much the lists take.  True past the limit: then and from then on all lists of the
    /// bucket are to be emptied.
    bool limit_lists();
    void clear_lists();
    bool overflowed() const { return m_overflowed; }
    /// Whether so much has arrived since cut_lists() that it is worth while again.
    bool lists_grew(std::size_t i) const;
    /// Leaves out of store i's lists what does not count whatever else may come.  The store must
    /// hold the nearest opaque surfaces so far; what hides the rest is put there.  Slots are
    /// samples.
    void cut_lists(std::size_t i, const ListEnd& end);
    /// Sorts the lists of store i once its opaque surfaces are known; these by slot of the lists.
    void finish_lists(std::size_t i, const OpaqueSurfaces& surfaces, const ListEnd& end);
    /// Of the pool's grids, by arrival, those that some sample sees; after finish_lists().
    std::vector<bool> seen_grids() const;
    /// Throws Cancelled; called between tiles, whose samples may be millions.
    void check_cancelled() const;

  private:
    void report_dropped(const Grid& grid, std::uint64_t dropped) const;

    HiderFrame m_frame;
    Rect m_tiles, m_pixels;
    GridPool m_pool;
    std::vector<TileStore> m_stores;
    Arena m_list_memory;
    std::vector<std::uint64_t> m_left;  ///< fragments of a tile when its lists were last cut
    std::vector<char> m_listed;         ///< 1 for ids that are in some list
    std::vector<TileSamples> m_samples;
    std::vector<SampleNeeds> m_needs;
    bool m_overflowed = false;
};

/// Depth keys that the clip range admits, and the kind of key.
DepthRange depth_range(const Projection& projection);

}  // namespace granita
