// SPDX-License-Identifier: GPL-3.0-or-later
// The oracle: every sample of every pixel that a micropolygon may touch, one by one, in double.
#include <algorithm>
#include <cmath>

#include "hider/bucket_tiles.h"
#include "hider/hider.h"
#include "hider/micropolygon.h"
#include "hider/micropolygon_class.h"

namespace granita {
namespace {

class ReferenceHider : public Hider {
  public:
    ReferenceHider(const HiderFrame& frame, const Rect& tiles, const Rect& pixels)
        : Hider(frame),
          m_statistics(frame.statistics),
          m_tiles(frame, tiles, pixels),
          m_range(depth_range(frame.projection)) {}

    /// Never culls: what it says cannot be wrong.
    bool occluded(const TimeSlab&) const override { return false; }

    void hide(const GridSweep& sweep) override {
        const Grid& grid = sweep.grid();
        const GridClasses& classes = sweep.classes();
        const SurfaceId base = m_tiles.add(grid, classes);
        if (m_statistics)
            m_statistics->add(Counter::Micropolygons,
                              static_cast<std::uint64_t>(grid.micropolygon_count()));
        for (std::size_t i = 0; i < m_tiles.count(); ++i)
            for (int m = 0; m < grid.micropolygon_count(); ++m)
                if (classes.classes[m])
                    hide_in_tile(grid, m, classes.classes[m], base + static_cast<SurfaceId>(m), i);
        if (!classes.opacity.empty() && m_tiles.limit_lists()) m_tiles.clear_lists();
    }
    bool overflowed() const override { return m_tiles.overflowed(); }

    std::vector<TileStore>& finish() override {
        // Whole lists: what compositing does not follow changes nothing.
        for (std::size_t i = 0; i < m_tiles.count(); ++i)
            m_tiles.finish_lists(i, surfaces_of(m_tiles.store(i)), ListEnd{});
        return m_tiles.stores();
    }
    const GridPool& pool() const override { return m_tiles.pool(); }
    std::vector<bool> seen_grids() const override { return m_tiles.seen_grids(); }
    const TileSamples& tile_samples(std::size_t i) const override { return m_tiles.samples(i); }
    void drop_samples() override { m_tiles.drop_samples(); }
    void make_samples() override { m_tiles.make_samples(); }

  private:
    /// Homogeneous in the tile's raster, in double throughout.
    Corner<double> corner(const Vec3f& p, const Vec2d& origin) const {
        const double z = p.z, w = m_projection.perspective ? z : 1.0;
        return {m_projection.scale.x * p.x + (m_projection.center.x - origin.x) * w,
                m_projection.scale.y * p.y + (m_projection.center.y - origin.y) * w, w, z};
    }

    /// Pixels of the tile that a micropolygon may touch; all of them where a corner is not in front
    /// of the eye.
    Rect pixels_touched(const Grid& grid, const int corners[4], std::size_t tile) const {
        double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
        for (int k = 0; k < (grid.motion ? grid.knots : 1); ++k)
            for (int i = 0; i < 4; ++i) {
                const Vec3f& p = grid.positions[k * grid.vertex_count() + corners[i]];
                const Corner<double> c = corner(p, m_tiles.origin(tile));
                if (c.w <= 0.0) return m_tiles.local_pixels(tile);
                const double blur = m_projection.lens_reach(c.z) / c.w;
                const double blur_x = m_projection.scale.x * blur * m_lens.extent().x + 0.01;
                const double blur_y = m_projection.scale.y * blur * m_lens.extent().y + 0.01;
                x0 = std::min(x0, c.x / c.w - std::fabs(blur_x));
                x1 = std::max(x1, c.x / c.w + std::fabs(blur_x));
                y0 = std::min(y0, c.y / c.w - std::fabs(blur_y));
                y1 = std::max(y1, c.y / c.w + std::fabs(blur_y));
            }
        const auto cell = [](double x) {
            return static_cast<int>(std::floor(std::clamp(x, -1.0, kTileSize + 1.0)));
        };
        return m_tiles.local_pixels(tile).intersect(
            {cell(x0), cell(y0), cell(x1) + 1, cell(y1) + 1});
    }

    void hide_in_tile(const Grid& grid, int m, std::uint8_t kind, SurfaceId id, std::size_t tile) {
        const Grid::Corners c = grid.corners(m);
        const int corners[4] = {c.v0, c.v1, c.v2, c.v3};
        const Rect pixels = pixels_touched(grid, corners, tile);
        if (pixels.empty()) return;
        if (grid.motion) m_tiles.need_time(tile);
        const int samples = m_tiles.samples(tile).samples;
        std::uint64_t hits = 0;
        for (int y = pixels.y0; y < pixels.y1; ++y)
            for (int x = pixels.x0; x < pixels.x1; ++x)
                for (int s = 0; s < samples; ++s) {
                    const auto i = static_cast<std::uint32_t>((y * kTileSize + x) * samples + s);
                    if (!exists(grid, tile, i)) continue;
                    const SurfaceHit hit = test(grid, corners, kind, tile, i);
                    if (!hit.hit) continue;
                    ++hits;
                    record(tile, i, hit, id, kind & kTransparent);
                }
        if (!m_statistics) return;
        m_statistics->add(grid.motion || m_projection.has_lens() ? Counter::SampleTestsMoving
                                                                 : Counter::SampleTestsStatic,
                          static_cast<std::uint64_t>(pixels.width()) * pixels.height() * samples);
        m_statistics->add(Counter::SampleHits, hits);
    }

    bool exists(const Grid& grid, std::size_t tile, std::uint32_t i) const {
        return grid.lifespan.is_whole() || grid.lifespan.contains(m_tiles.samples(tile).t[i]);
    }

    SurfaceHit test(const Grid& grid, const int corners[4], unsigned triangles, std::size_t tile,
                    std::uint32_t i) const {
        const TileSamples& samples = m_tiles.samples(tile);
        Corner<double> c[4];
        Offset<double> d[4];
        int segment = 0;
        double local = 0.0;
        if (grid.motion) {
            const double place = static_cast<double>(samples.t[i]) * (grid.knots - 1);
            segment = std::min(static_cast<int>(place), grid.knots - 2);
            local = place - segment;
        }
        for (int k = 0; k < 4; ++k) {
            const Vec3f* p = &grid.positions[segment * grid.vertex_count() + corners[k]];
            c[k] = corner(*p, m_tiles.origin(tile));
            if (grid.motion) {
                const Corner<double> e = corner(p[grid.vertex_count()], m_tiles.origin(tile));
                const Corner<double> delta{e.x - c[k].x, e.y - c[k].y, e.w - c[k].w, e.z - c[k].z};
                c[k] = at_time(c[k], delta, local);
            }
            const double x = samples.x[i], y = samples.y[i];
            if (m_projection.has_lens())
                d[k] = offset_lens(c[k], x, y,
                                   samples.u[i] * m_projection.lens_radius * m_projection.scale.x,
                                   samples.v[i] * m_projection.lens_radius * m_projection.scale.y,
                                   samples.inverse_focus.empty() ? 1.0 / m_projection.focus
                                                                 : samples.inverse_focus[i],
                                   1.0);
            else
                d[k] = offset_pinhole(c[k], x, y);
        }
        return hit_micropolygon(c, d, triangles, m_range);
    }

    void record(std::size_t tile, std::uint32_t i, const SurfaceHit& hit, SurfaceId id,
                bool transparent) {
        TileStore& store = m_tiles.store(tile);
        if (transparent) {
            store.lists.prepare(store.key.size(), m_tiles.list_memory());
            store.lists.add(i, fragment_of(hit, id));
            if (m_statistics) m_statistics->add(Counter::FragmentsStored);
        } else if (m_tiles.wins(hit.key, id, store.key[i], store.id[i])) {
            store.key[i] = hit.key;
            store.id[i] = id;
        }
    }

    Statistics* m_statistics;
    BucketTiles m_tiles;
    DepthRange m_range;
};

}  // namespace

std::unique_ptr<Hider> make_reference_hider(const HiderFrame& frame, const Rect& tiles,
                                            const Rect& pixels) {
    return std::make_unique<ReferenceHider>(frame, tiles, pixels);
}

}  // namespace granita
