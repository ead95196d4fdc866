// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/render_bucket.h"

#include "base/stage_timer.h"
#include "render/bucket_parts.h"
#include "render/neighbour_grids.h"
#include "render/raster_bucket.h"
#include "render/refine_samples.h"
#include "render/resolved_tile.h"
#include "render/tile_colors.h"
#include "render/tile_volumes.h"
#include "render/visit_geometry.h"

namespace granita {
namespace {

Rect tile_pixels(const Rect& tiles) {
    return {tiles.x0 * kTileSize, tiles.y0 * kTileSize, tiles.x1 * kTileSize, tiles.y1 * kTileSize};
}

/// The bucket's share of the frame's geometry is given back on every path.
class Release {
  public:
    Release(FrameGeometry& geometry, int bucket) : m_geometry(geometry), m_bucket(bucket) {}
    ~Release() { m_geometry.release(m_bucket); }
    Release(const Release&) = delete;
    Release& operator=(const Release&) = delete;

  private:
    FrameGeometry& m_geometry;
    int m_bucket;
};

/// What the bucket had to pay for.
void count_needs(Frame& frame, const HiddenGrids& grids) {
    bool moving = frame.view.projection.has_lens() && !grids.empty(), transparent = false;
    for (const auto& grid : grids) {
        moving |= grid->grid().motion;
        transparent |= grid->grid().opacity_varies;
    }
    frame.statistics.add(Counter::BucketsMoving, moving);
    frame.statistics.add(Counter::BucketsTransparent, transparent);
}

void hide_geometry(Frame& frame, int bucket, const Rect& reach, Hider& hider, HiddenGrids& grids) {
    const StageTimer timer(frame.statistics, Stage::Hide);  // but for what is opened or diced
    const auto occluded = [&](const TimeSlab& slab) { return hider.occluded(slab); };
    visit_geometry(frame, bucket, reach, occluded, [&](std::shared_ptr<SharedGrid> grid) {
        if (frame.shading.opacity_varies(grid->grid().material))
            grid->ensure_opacity(frame.shading, frame.statistics);
        hider.hide(grid->sweep(frame.view.projection, frame.lens()));
        grids.push_back(std::move(grid));
    });
}

/// Composites and filters every tile of a hider that has finished, whose grids that are `seen` are
/// shaded.
std::vector<ResolvedTile> resolve(Frame& frame, Hider& hider, const std::vector<bool>& seen) {
    const std::vector<TileStore>& stores = hider.finish();
    const BucketRefinement refinement(frame, hider, stores, seen);
    LayerTable layers(hider.pool(), seen);
    std::vector<ResolvedTile> resolved;
    resolved.reserve(stores.size());
    TileColors colors(frame, hider.table());
    for (std::size_t i = 0; i < stores.size(); ++i) {
        const TileSamples& samples = hider.tile_samples(i);
        const Vec2i tile = stores[i].tile;
        colors.composite(stores[i], samples, layers, refinement.tile(i));
        resolved.push_back(colors.resolve(tile, samples));
    }
    return resolved;
}

/// Whether the lists did fit, and what lies between their layers.
bool finish(Frame& frame, Hider& hider) {
    const StageTimer timer(frame.statistics, Stage::Hide);
    const std::vector<TileStore>& stores = hider.finish();
    return !hider.overflowed() && volumes_fit(frame, stores);
}

/// These tiles of the bucket, seen with the samples of one level.
std::vector<ResolvedTile> look(Frame& frame, int bucket, int level, const Rect& tiles) {
    const SampleTable& table = frame.levels.table(level);
    const Rect pixels = tile_pixels(tiles).intersect(frame.layout.pixels(bucket));
    HiddenGrids grids;
    {
        HiderFrame settings = frame.hider;
        settings.table = &table;
        auto hider = make_hider(settings, frame.choice, tiles, pixels);
        hide_geometry(frame, bucket, pixels, *hider, grids);
        if (level == 0) count_needs(frame, grids);
        if (finish(frame, *hider)) {
            std::vector<HiddenGrids> around;
            std::vector<bool> seen =
                shade_seen(frame, bucket, *hider, grids, frame.visibility ? &around : nullptr);
            auto resolved = resolve(frame, *hider, seen);
            if (frame.visibility)
                frame.visibility->keep(bucket, {std::move(hider), std::move(grids), std::move(seen),
                                                std::move(around)});
            return resolved;
        }
    }
    return resolve_in_parts(frame, bucket, table, tiles, pixels, grids);
}

/// As an earlier picture has seen it.
std::vector<ResolvedTile> look_again(Frame& frame, int bucket) {
    const PersistentVisibility::Bucket& kept = *frame.visibility->bucket(bucket);
    frame.statistics.add(Counter::BucketsSeenBefore);
    shade_grids(frame, bucket, kept.grids, kept.seen, kept.around);
    kept.hider->make_samples();
    std::vector<ResolvedTile> resolved = resolve(frame, *kept.hider, kept.seen);
    kept.hider->drop_samples();
    return resolved;
}

/// With more samples, until its samples are enough.
void look_closer(Frame& frame, int bucket, ResolvedTile& tile) {
    for (int level = 0, next; (next = frame.levels.next(level, tile.noise)) != level;
         level = next) {
        frame.statistics.add(Counter::TilesResampled);
        const Vec2i at = tile.contribution.tile;
        tile = std::move(look(frame, bucket, next, {at.x, at.y, at.x + 1, at.y + 1}).front());
    }
}

}  // namespace

std::vector<Tile> render_bucket(Frame& frame, int bucket) {
    const Release release(frame.geometry, bucket);
    if (frame.raster) return {raster_bucket(frame, bucket)};
    std::vector<TileContribution> contributions;
    std::vector<ResolvedTile> tiles = frame.sees_anew
                                          ? look(frame, bucket, 0, frame.layout.tiles(bucket))
                                          : look_again(frame, bucket);
    for (ResolvedTile& tile : tiles) {
        look_closer(frame, bucket, tile);
        contributions.push_back(std::move(tile.contribution));
    }
    const StageTimer timer(frame.statistics, Stage::Film);
    return frame.film.add(std::move(contributions));
}

}  // namespace granita
