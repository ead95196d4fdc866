// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/bucket_parts.h"

#include "base/stage_timer.h"
#include "hider/compute/compute_hider.h"
#include "render/refine_samples.h"
#include "render/tile_colors.h"
#include "render/tile_volumes.h"

namespace granita {
namespace {

class TileParts {
  public:
    TileParts(Frame& frame, int bucket, const SampleTable& table, Vec2i tile,
              const HiddenGrids& grids)
        : m_frame(frame),
          m_bucket(bucket),
          m_table(table),
          m_tile(tile),
          m_grids(grids),
          m_colors(frame, table) {}

    /// `pixels`: of the tile, in the frame's coordinates.
    ResolvedTile resolve(const Rect& pixels) {
        add(pixels);
        return m_colors.resolve(m_tile, m_samples);
    }

  private:
    void add(const Rect& pixels) {
        HiderFrame settings = m_frame.hider;
        settings.table = &m_table;
        // The lists of one pixel are needed whatever they take.
        const bool is_pixel = pixels.width() == 1 && pixels.height() == 1;
        if (is_pixel) settings.list_bytes = ~std::uint64_t{0};
        HiddenGrids hidden;
        const auto hider = hide(settings, pixels, hidden);
        const std::vector<TileStore>* stores = nullptr;
        if (!hider->overflowed()) {
            const StageTimer timer(m_frame.statistics, Stage::Hide);
            stores = &hider->finish();
        }
        if (hider->overflowed() || (!is_pixel && !volumes_fit(m_frame, *stores)))
            return add_halves(pixels);
        const std::vector<bool> seen = shade_seen(m_frame, m_bucket, *hider, hidden);
        const BucketRefinement refinement(m_frame, *hider, *stores, seen);
        LayerTable layers(hider->pool(), seen);
        m_samples = hider->tile_samples(0);
        TileColors part(m_frame, m_table);
        part.composite(stores->front(), m_samples, layers, refinement.tile(0));
        const Vec2i corner = m_tile * kTileSize;
        m_colors.take(part,
                      {pixels.x0 - corner.x, pixels.y0 - corner.y, pixels.x1 - corner.x,
                       pixels.y1 - corner.y},
                      m_samples.samples);
    }

    std::unique_ptr<Hider> hide(const HiderFrame& settings, const Rect& pixels,
                                HiddenGrids& hidden) {
        const StageTimer timer(m_frame.statistics, Stage::Hide);
        auto hider = make_hider(settings, m_frame.choice,
                                {m_tile.x, m_tile.y, m_tile.x + 1, m_tile.y + 1}, pixels);
        for (const auto& grid : m_grids) {
            if (hider->overflowed()) break;
            if (hider->occluded(grid->grid().bounds)) continue;
            hider->hide(grid->sweep(m_frame.view.projection, m_frame.lens()));
            hidden.push_back(grid);
        }
        return hider;
    }

    void add_halves(const Rect& r) {
        m_frame.progress.check();
        if (r.height() >= r.width()) {
            const int y = r.y0 + r.height() / 2;
            add({r.x0, r.y0, r.x1, y});
            add({r.x0, y, r.x1, r.y1});
        } else {
            const int x = r.x0 + r.width() / 2;
            add({r.x0, r.y0, x, r.y1});
            add({x, r.y0, r.x1, r.y1});
        }
    }

    Frame& m_frame;
    const int m_bucket;
    const SampleTable& m_table;
    Vec2i m_tile;
    const HiddenGrids& m_grids;
    TileSamples m_samples;
    TileColors m_colors;
};

}  // namespace

std::unique_ptr<Hider> make_hider(const HiderFrame& settings, const ExecutorChoice& choice,
                                  const Rect& tiles, const Rect& pixels) {
    if (choice.compute) return make_compute_hider(*choice.compute, settings, tiles, pixels);
    return choice.executor == Executor::Reference ? make_reference_hider(settings, tiles, pixels)
                                                  : make_simd_hider(settings, tiles, pixels);
}

std::vector<ResolvedTile> resolve_in_parts(Frame& frame, int bucket, const SampleTable& table,
                                           const Rect& tiles, const Rect& pixels,
                                           const HiddenGrids& grids) {
    std::vector<ResolvedTile> resolved;
    for (int y = tiles.y0; y < tiles.y1; ++y)
        for (int x = tiles.x0; x < tiles.x1; ++x) {
            const Rect own{x * kTileSize, y * kTileSize, (x + 1) * kTileSize, (y + 1) * kTileSize};
            resolved.push_back(
                TileParts(frame, bucket, table, {x, y}, grids).resolve(own.intersect(pixels)));
        }
    return resolved;
}

}  // namespace granita
