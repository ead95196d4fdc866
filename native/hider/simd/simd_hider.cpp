// SPDX-License-Identifier: GPL-3.0-or-later
// The CPU executor: grid by grid and tile by tile through the SIMD kernel, behind a hierarchical
// depth.
#include <algorithm>
#include <cmath>

#include "base/object_pool.h"
#include "hider/bucket_tiles.h"
#include "hider/hider.h"
#include "hider/simd/simd_kernel.h"
#include "hider/simd/tile_grid.h"
#include "hider/simd/working_tile.h"

namespace granita {
namespace {

class SimdHider : public Hider {
  public:
    SimdHider(const HiderFrame& frame, const Rect& tiles, const Rect& pixels)
        : Hider(frame),
          m_statistics(frame.statistics),
          m_list_end(frame.list_end),
          m_z_batch_size(frame.z_batch_size),
          m_tiles(frame, tiles, pixels),
          m_working(m_tiles.count()),
          m_tile_grid(frame.projection, frame.table->lens()),
          m_range(depth_range(frame.projection)),
          m_lens_scale(frame.projection.lens_radius * frame.projection.scale) {}

    bool occluded(const TimeSlab& slab) const override {
        const Rect touched = m_tiles.touched(slab.bounds);
        for (int y = touched.y0; y < touched.y1; ++y)
            for (int x = touched.x0; x < touched.x1; ++x)
                if (!tile_hides(m_tiles.index(x, y), slab, Depth::Refreshed)) return false;
        return true;
    }

    void hide(const GridSweep& sweep) override {
        const Grid& grid = sweep.grid();
        const SurfaceId base = m_tiles.add(grid, sweep.classes());
        m_tile_grid.load(sweep);
        const bool transparent = !sweep.classes().opacity.empty();
        SimdCounts counts;
        bool hidden = true;
        const Rect touched = m_tiles.touched(grid.bounds);
        for (int y = touched.y0; y < touched.y1; ++y)
            for (int x = touched.x0; x < touched.x1; ++x) {
                const std::size_t i = m_tiles.index(x, y);
                if (tile_hides(i, sweep)) continue;
                hidden = false;
                m_tiles.check_cancelled();
                arrange(i, grid.motion, sweep.reach());
                hide_in_tile(transparent, base, i, counts);
            }
        if (counts.fragments > 0) limit_lists();
        if (!m_statistics) return;
        m_statistics->add(Counter::GridsCulled, hidden && !touched.empty());
        m_statistics->add(Counter::Micropolygons,
                          static_cast<std::uint64_t>(grid.micropolygon_count()));
        m_statistics->add(grid.motion || m_projection.has_lens() ? Counter::SampleTestsMoving
                                                                 : Counter::SampleTestsStatic,
                          counts.tests);
        m_statistics->add(Counter::SampleHits, counts.hits);
        m_statistics->add(Counter::FragmentsStored, counts.fragments);
    }

    bool overflowed() const override { return m_tiles.overflowed(); }

    std::vector<TileStore>& finish() override {
        for (std::size_t i = 0; i < m_tiles.count(); ++i) {
            if (!m_working[i].tile) continue;
            WorkingTile& working = *m_working[i].tile;
            working.store_lists(m_tiles.store(i));
            m_tiles.finish_lists(i, working.surfaces(), m_list_end);
            working.store_surfaces(m_tiles.store(i));
            ObjectPool<std::unique_ptr<WorkingTile>>::give(std::move(m_working[i].tile));
        }
        return m_tiles.stores();
    }
    const GridPool& pool() const override { return m_tiles.pool(); }
    std::vector<bool> seen_grids() const override { return m_tiles.seen_grids(); }
    const TileSamples& tile_samples(std::size_t i) const override { return m_tiles.samples(i); }
    void drop_samples() override { m_tiles.drop_samples(); }
    void make_samples() override { m_tiles.make_samples(); }

  private:
    void limit_lists() {
        if (!m_tiles.limit_lists()) return;
        for (Working& working : m_working)
            if (working.tile) working.tile->lists.clear();
    }

    /// By the grid's bounds while it exists or, where it moves, by those of each part of the
    /// shutter.
    bool tile_hides(std::size_t i, const GridSweep& sweep) const {
        const Grid& grid = sweep.grid();
        const Lifespan& life = grid.lifespan;
        const TimeSlab whole{std::max(0.0f, life.open), std::min(life.close, 1.0f), grid.bounds};
        if (tile_hides(i, whole)) return true;
        if (!grid.motion || !m_working[i].tile || !m_working[i].tile->hides_something())
            return false;
        return std::all_of(sweep.slabs().begin(), sweep.slabs().end(), [&](const TimeSlab& slab) {
            return !slab.bounds.visible || !life.meets(slab.t0, slab.t1) || tile_hides(i, slab);
        });
    }

    enum class Depth { AsItIs, Refreshed };
    bool tile_hides(std::size_t i, const TimeSlab& slab, Depth depth = Depth::AsItIs) const {
        if (!m_working[i].tile) return false;
        WorkingTile& tile = *m_working[i].tile;
        const RasterBounds& bounds = slab.bounds;
        const Vec2d origin = m_tiles.origin(i);
        const auto pixel = [](double x) {
            return static_cast<int>(std::floor(std::fmin(std::fmax(x, -1.0), kTileSize)));
        };
        // An undecidable bound (NaN) covers the tile: fmax and fmin drop the NaN.
        const Rect pixels{std::isnan(bounds.x0) ? 0 : pixel(bounds.x0 - origin.x),
                          std::isnan(bounds.y0) ? 0 : pixel(bounds.y0 - origin.y),
                          std::isnan(bounds.x1) ? kTileSize : pixel(bounds.x1 - origin.x) + 1,
                          std::isnan(bounds.y1) ? kTileSize : pixel(bounds.y1 - origin.y) + 1};
        const auto hides = [&] { return tile.hides(pixels, slab.t0, slab.t1, bounds.nearest_key); };
        return hides() || (depth == Depth::Refreshed && tile.refresh_depth() && hides());
    }

    /// Sees to it that the tile's samples lie in an order that suits grids which go this far.
    void arrange(std::size_t i, bool moving, const Sweep& sweep) {
        Working& working = m_working[i];
        const bool needs_time = moving && !m_tiles.has_time(i);
        if (working.tile && !needs_time && !working.outgrown_by(sweep)) return;
        working.sweep.motion = glm::max(working.sweep.motion, sweep.motion);
        working.sweep.lens = glm::max(working.sweep.lens, sweep.lens);
        if (needs_time) m_tiles.need_time(i);
        const TileSamples& samples = m_tiles.samples(i);
        const OrderShape shape = best_order(samples.samples, working.sweep);
        if (!working.tile)
            (working.tile = take_tile())
                ->begin(samples, m_tiles.local_pixels(i), m_lens_scale, shape,
                        m_tiles.list_memory());
        else if (needs_time || shape != working.tile->shape())
            working.tile->reorder(samples, shape);
    }

    static std::unique_ptr<WorkingTile> take_tile() {
        auto tile = ObjectPool<std::unique_ptr<WorkingTile>>::take();
        return tile ? std::move(tile) : std::make_unique<WorkingTile>();
    }

    void hide_in_tile(bool transparent, SurfaceId base, std::size_t i, SimdCounts& counts) {
        WorkingTile& working = *m_working[i].tile;
        SimdGrid simd_grid = m_tile_grid.project(m_tiles.origin(i));
        if (simd_grid.parts.empty()) return;
        simd_grid.base = base;
        simd_grid.pool = &m_tiles.pool();
        simd_grid.range = m_range;
        if (transparent) working.prepare_lists();
        const SimdCounts before = counts;
        hide_grid_in_tile(simd_grid, working.view(), working.lists, counts);
        working.note_writes(counts.writes - before.writes);
        if (transparent && m_list_end.opacity_threshold < 1.0f)
            working.end_lists(counts.fragments - before.fragments, m_tiles.pool(), m_list_end,
                              m_z_batch_size);
        working.update_depth();
    }

    /// A tile from the first grid that comes, and the largest sweep it was arranged for.
    struct Working {
        std::unique_ptr<WorkingTile> tile;
        Sweep sweep;

        /// By half, which bounds the number of times a tile is arranged anew.
        bool outgrown_by(const Sweep& s) const {
            return s.motion.x > 1.5f * sweep.motion.x || s.motion.y > 1.5f * sweep.motion.y ||
                   s.lens.x > 1.5f * sweep.lens.x || s.lens.y > 1.5f * sweep.lens.y;
        }
    };

    Statistics* m_statistics;
    ListEnd m_list_end;
    int m_z_batch_size;
    BucketTiles m_tiles;
    std::vector<Working> m_working;
    TileGrid m_tile_grid;
    DepthRange m_range;
    Vec2f m_lens_scale;  ///< lens radius times scale
};

}  // namespace

std::unique_ptr<Hider> make_simd_hider(const HiderFrame& frame, const Rect& tiles,
                                       const Rect& pixels) {
    return std::make_unique<SimdHider>(frame, tiles, pixels);
}

}  // namespace granita
