// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/render_bucket.h"

#include <algorithm>

#include "hider/composite.h"
#include "hider/compute_hider.h"
#include "render/background.h"
#include "render/raster_bucket.h"
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

std::unique_ptr<Hider> make_hider(const Frame& frame, int bucket) {
    const Rect tiles = frame.layout.tiles(bucket), pixels = frame.layout.pixels(bucket);
    if (frame.choice.compute)
        return make_compute_hider(*frame.choice.compute, frame.hider, tiles, pixels);
    return frame.choice.executor == Executor::Reference
               ? make_reference_hider(frame.hider, tiles, pixels)
               : make_simd_hider(frame.hider, tiles, pixels);
}

/// Slots (arrival order) of the grids that some sample has seen.
std::vector<bool> seen_grids(const std::vector<TileStore>& stores, const GridPool& pool) {
    // A mark for each micropolygon, and one for nothing: no question a sample.
    const SurfaceId end = pool.id_end();
    std::vector<char> marks(static_cast<std::size_t>(end) + 1, 0);
    for (const TileStore& store : stores) {
        for (const SurfaceId id : store.id) marks[std::min(id, end)] = 1;
        for (const Fragment& fragment : store.fragments) marks[fragment.id] = 1;
    }
    std::vector<bool> seen(pool.size(), false);
    auto next = marks.begin();
    for (std::uint32_t slot = 0; slot < pool.size(); ++slot) {
        const auto first = next;
        next += pool.grid(slot).micropolygon_count();
        seen[slot] = std::find(first, next, 1) != next;
    }
    return seen;
}

/// What the bucket had to pay for.
void count_needs(Frame& frame, const std::vector<std::shared_ptr<SharedGrid>>& grids) {
    bool moving = frame.view.projection.has_lens() && !grids.empty(), transparent = false;
    for (const auto& grid : grids) {
        moving |= grid->grid().motion;
        transparent |= grid->grid().opacity_varies;
    }
    frame.statistics.add(Counter::BucketsMoving, moving);
    frame.statistics.add(Counter::BucketsTransparent, transparent);
}

/// Composites and filters every tile.
std::vector<TileContribution> resolve(Frame& frame, std::vector<TileStore>& stores,
                                      const Hider& hider) {
    const Options& options = frame.scene.options;
    const ChannelSet& channels = frame.film.channels();
    const bool has_passes = options.depth_pass || !channels.empty();
    const CompositeSettings settings{frame.view.projection, options.opacity_threshold,
                                     options.film_transparent,
                                     has_passes ? options.pass_alpha_threshold : 0.0f, &channels};
    std::vector<TileContribution> contributions;
    contributions.reserve(stores.size());
    SampleColors colors;
    SampleChannels values;
    for (std::size_t i = 0; i < stores.size(); ++i) {
        frame.progress.check();
        const TileSamples& samples = hider.tile_samples(i);
        frame.statistics.add(Counter::SamplesTotal, samples.x.size());
        std::vector<Vec3f> background{Vec3f(0.0f)};
        if (!options.film_transparent || channels.has_environment()) {
            const StageTimer timer(frame.statistics, Stage::Shade);
            background = tile_background(frame.scene.camera, frame.table, frame.shading,
                                         frame.constant_background, stores[i]);
        }
        const StageTimer timer(frame.statistics, Stage::Resolve);
        composite_tile(stores[i], samples, hider.pool(), background, settings, colors, &values);
        contributions.push_back(frame.film.filter_tile(stores[i].tile, samples, colors, &values));
    }
    return contributions;
}

}  // namespace

std::vector<Tile> render_bucket(Frame& frame, int bucket) {
    const Release release(frame.geometry, bucket);
    if (frame.raster) return {raster_bucket(frame, bucket)};
    std::vector<std::shared_ptr<SharedGrid>> grids;  // in the hider's arrival order
    const auto hider = make_hider(frame, bucket);

    const auto occluded = [&](const RasterBounds& bounds) { return hider->occluded(bounds); };
    visit_geometry(frame, bucket, occluded, [&](std::shared_ptr<SharedGrid> grid) {
        if (frame.shading.opacity_varies(grid->grid().material))
            grid->ensure_opacity(frame.shading);
        const StageTimer timer(frame.statistics, Stage::Hide);
        hider->hide(grid->grid());
        grids.push_back(std::move(grid));
    });
    count_needs(frame, grids);

    std::vector<TileStore>* stores = nullptr;
    std::vector<bool> seen;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        stores = &hider->finish();
        seen = seen_grids(*stores, hider->pool());
    }
    for (std::size_t slot = 0; slot < grids.size(); ++slot) {
        frame.progress.check();
        if (seen[slot]) grids[slot]->ensure_radiance(frame.shading);
    }
    auto contributions = resolve(frame, *stores, *hider);
    const StageTimer timer(frame.statistics, Stage::Film);
    return frame.film.add(std::move(contributions));
}

}  // namespace granita
