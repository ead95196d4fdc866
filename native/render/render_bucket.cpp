// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/render_bucket.h"

#include "base/stage_timer.h"
#include "render/bucket_parts.h"
#include "render/raster_bucket.h"
#include "render/refine_samples.h"
#include "render/tile_colors.h"
#include "render/visit_geometry.h"

namespace granita {
namespace {

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

void hide_geometry(Frame& frame, int bucket, Hider& hider, HiddenGrids& grids) {
    const StageTimer timer(frame.statistics, Stage::Hide);  // but for what is opened or diced
    const auto occluded = [&](const TimeSlab& slab) { return hider.occluded(slab); };
    visit_geometry(frame, bucket, occluded, [&](std::shared_ptr<SharedGrid> grid) {
        if (frame.shading.opacity_varies(grid->grid().material))
            grid->ensure_opacity(frame.shading);
        hider.hide(grid->sweep(frame.view.projection, frame.table.lens()));
        grids.push_back(std::move(grid));
    });
}

/// Composites and filters every tile; none where the lists did not fit.
std::vector<TileContribution> resolve(Frame& frame, Hider& hider, const HiddenGrids& grids) {
    const std::vector<TileStore>* stores = nullptr;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        stores = &hider.finish();
    }
    if (hider.overflowed()) return {};
    const std::vector<bool> seen = shade_seen(frame, hider, grids);
    const BucketRefinement refinement(frame, hider, *stores, seen);
    LayerTable table(hider.pool(), seen);
    std::vector<TileContribution> contributions;
    contributions.reserve(stores->size());
    TileColors colors(frame);
    for (std::size_t i = 0; i < stores->size(); ++i) {
        const TileSamples& samples = hider.tile_samples(i);
        colors.composite((*stores)[i], samples, table, refinement.tile(i));
        contributions.push_back(colors.filter((*stores)[i].tile, samples));
    }
    return contributions;
}

}  // namespace

std::vector<Tile> render_bucket(Frame& frame, int bucket) {
    const Release release(frame.geometry, bucket);
    if (frame.raster) return {raster_bucket(frame, bucket)};
    HiddenGrids grids;
    std::vector<TileContribution> contributions;
    {
        const auto hider = make_hider(frame.hider, frame.choice, frame.layout.tiles(bucket),
                                      frame.layout.pixels(bucket));
        hide_geometry(frame, bucket, *hider, grids);
        count_needs(frame, grids);
        contributions = resolve(frame, *hider, grids);
    }
    if (contributions.empty()) contributions = resolve_in_parts(frame, bucket, grids);
    const StageTimer timer(frame.statistics, Stage::Film);
    return frame.film.add(std::move(contributions));
}

}  // namespace granita
