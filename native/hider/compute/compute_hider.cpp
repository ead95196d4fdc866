// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/compute/compute_hider.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hider/compute/compute_tiles.h"
#include "hider/resolve/surface_interpolator.h"
#include "hider/simd/tile_grid.h"

namespace granita {
namespace {

constexpr int kBlockSide = 4, kBlocks = kTileSize / kBlockSide;

using Copies = std::vector<gl::Readback>;

/// Tiles that share buffers, and what is on its way to them.
struct TileGroup {
    TileGroup(std::size_t first_tile, std::size_t tile_count, const ComputeLimits& limits)
        : first(first_tile), count(tile_count), batch(limits) {}
    std::size_t first, count;
    ComputeBatch batch;
    std::optional<ComputeTiles> device;  ///< made with the first batch
    Copies copies;                       ///< of the last fetch()
};

class ComputeHider : public Hider {
  public:
    ComputeHider(ComputeDevice& device, const HiderFrame& frame, const Rect& tiles,
                 const Rect& pixels)
        : Hider(frame),
          m_device(device),
          m_frame(frame),
          m_tiles(m_frame, tiles, pixels),
          m_tile_grid(frame.projection, frame.table->lens()),
          m_group_size(ComputeTiles::capacity(frame.table->samples(), device.limits())),
          m_farthest(m_tiles.count() * kBlocks * kBlocks, -INFINITY) {
        for (std::size_t first = 0; first < m_tiles.count(); first += m_group_size)
            m_groups.emplace_back(first, std::min(m_group_size, m_tiles.count() - first),
                                  device.limits());
    }
    ~ComputeHider() override {
        m_device.thread().run([&] { m_groups.clear(); });
    }
    ComputeHider(const ComputeHider&) = delete;
    ComputeHider& operator=(const ComputeHider&) = delete;

    /// Its depth knows no times.
    bool occluded(const TimeSlab& slab) const override {
        const RasterBounds& bounds = slab.bounds;
        const Rect touched = m_tiles.touched(bounds);
        for (int y = touched.y0; y < touched.y1; ++y)
            for (int x = touched.x0; x < touched.x1; ++x)
                if (!tile_hides(m_tiles.index(x, y), bounds)) return false;
        return true;
    }

    void hide(const GridSweep& sweep) override {
        const Grid& grid = sweep.grid();
        const SurfaceId base = m_tiles.add(grid, sweep.classes());
        if (m_frame.statistics)
            m_frame.statistics->add(Counter::Micropolygons,
                                    static_cast<std::uint64_t>(grid.micropolygon_count()));
        m_tile_grid.load(sweep);
        const Rect touched = m_tiles.touched(grid.bounds);
        for (int y = touched.y0; y < touched.y1; ++y)
            for (int x = touched.x0; x < touched.x1; ++x) {
                const std::size_t i = m_tiles.index(x, y);
                if (tile_hides(i, grid.bounds)) continue;
                SimdGrid in_tile = m_tile_grid.project(m_tiles.origin(i));
                in_tile.base = base;
                TileGroup& group = m_groups[i / m_group_size];
                group.batch.add(in_tile, static_cast<std::uint32_t>(i - group.first),
                                m_tiles.local_pixels(i), [&] { run(group); });
            }
    }

    bool overflowed() const override { return m_tiles.overflowed(); }

    std::vector<TileStore>& finish() override {
        for (TileGroup& group : m_groups) {
            if (group.batch.empty() && !group.device) continue;
            const auto seen = [&](ComputeTiles& device) {
                return device.seen(group.first, group.count);
            };
            const auto take = [&](const gl::Readback& copy) {
                group.device->take(copy, group.first);
            };
            if (!group.batch.empty()) {
                hide_batch(group, seen, take);
                for (const std::size_t i : grown_lists(group))
                    m_tiles.cut_lists(i, m_frame.list_end);
                limit_lists();
                group.batch.clear();
            } else {
                fetch(group, [&](ComputeTiles& device, Copies& copies) {
                    copies.push_back(seen(device));
                });
                take(group.copies.front());
            }
            m_device.thread().run([&] {
                group.copies.clear();
                group.device.reset();
            });
        }
        for (std::size_t i = 0; i < m_tiles.count(); ++i) {
            m_tiles.finish_lists(i, surfaces_of(m_tiles.store(i)), m_frame.list_end);
            weigh_fragments(i);
        }
        return m_tiles.stores();
    }
    const GridPool& pool() const override { return m_tiles.pool(); }
    std::vector<bool> seen_grids() const override { return m_tiles.seen_grids(); }
    const TileSamples& tile_samples(std::size_t i) const override { return m_tiles.samples(i); }
    void drop_samples() override { m_tiles.drop_samples(); }
    void make_samples() override { m_tiles.make_samples(); }

  private:
    /// Where samples meet their fragments: the device hands over keys and ids.
    void weigh_fragments(std::size_t i) {
        TileStore& store = m_tiles.store(i);
        if (store.lists.empty()) return;
        SurfaceInterpolator surface(m_frame.projection, store.tile, m_tiles.samples(i),
                                    m_tiles.pool(), false);
        for (std::uint32_t s = 0; s < store.key.size(); ++s)
            for (std::uint32_t k = 0; k < store.lists.counts()[s]; ++k) {
                const Fragment fragment = store.lists.at(s, k);
                store.lists.set(s, k, surface.fragment(s, fragment.id, fragment.key));
            }
    }

    /// Tiles whose lists may have ended.
    std::vector<std::size_t> grown_lists(const TileGroup& group) const {
        std::vector<std::size_t> grown;
        if (m_frame.list_end.opacity_threshold < 1.0f)
            for (std::size_t i = group.first; i < group.first + group.count; ++i)
                if (m_tiles.lists_grew(i)) grown.push_back(i);
        return grown;
    }

    /// Runs `begin` on the device's thread, which leaves copies on their way, and waits for them in
    /// a job of their own: between the two the device works for other buckets.
    template <class Begin>
    void fetch(TileGroup& group, const Begin& begin) {
        m_device.thread().run([&] {
            group.copies.clear();
            begin(*group.device, group.copies);
        });
        m_device.thread().run([&] { group.copies.back().wait(); });
    }

    /// Sends the batch and takes over what it hit.  `copy` begins a copy of what is on the device
    /// afterwards, which `use` is called with.
    template <class Copy, class Use>
    void hide_batch(TileGroup& group, const Copy& copy, const Use& use) {
        m_tiles.check_cancelled();
        if (!group.device)
            group.device.emplace(m_device, m_tiles, m_frame, group.first, group.count);
        group.device->stage(group.batch);
        fetch(group, [&](ComputeTiles& device, Copies& copies) {
            device.hide();
            copies.push_back(copy(device));
            if (auto counts = device.counts()) copies.push_back(std::move(*counts));
        });
        use(group.copies.front());
        if (group.copies.size() == 1) return;
        for (const ComputeTiles::Part& part : group.device->parts(group.copies.back())) {
            fetch(group, [&](ComputeTiles& device, Copies& copies) {
                copies.push_back(device.fill(part));
            });
            group.device->collect(part, group.copies.front());
        }
    }

    void run(TileGroup& group) {
        hide_batch(
            group, [](ComputeTiles& device) { return device.farthest(); },
            [&](const gl::Readback& copy) { keep_farthest(group, copy); });
        if (const std::vector<std::size_t> grown = grown_lists(group); !grown.empty())
            cut_lists(group, grown);
        limit_lists();
        group.batch.clear();
    }

    void limit_lists() {
        if (m_tiles.limit_lists()) m_tiles.clear_lists();
    }

    /// z-batches: what is behind the end of a list is dropped, and hidden as behind opaque
    /// surfaces.
    void cut_lists(TileGroup& group, const std::vector<std::size_t>& tiles) {
        fetch(group, [&](ComputeTiles& device, Copies& copies) {
            for (const std::size_t i : tiles) copies.push_back(device.seen(i, 1));
        });
        for (std::size_t k = 0; k < tiles.size(); ++k) {
            group.device->take(group.copies[k], tiles[k]);
            m_tiles.cut_lists(tiles[k], m_frame.list_end);
        }
        fetch(group, [&](ComputeTiles& device, Copies& copies) {
            for (const std::size_t i : tiles) device.write_back(i);
            copies.push_back(device.farthest());
        });
        keep_farthest(group, group.copies.front());
    }

    void keep_farthest(const TileGroup& group, const gl::Readback& farthest) {
        std::ranges::copy(
            farthest.values<float>(),
            m_farthest.begin() + static_cast<std::ptrdiff_t>(group.first * kBlocks * kBlocks));
    }

    /// Whether the last batch left nothing of the tile that is farther than the bounds.  Keys only
    /// come nearer, so what is on its way only culls less.
    bool tile_hides(std::size_t i, const RasterBounds& bounds) const {
        const Vec2d origin = m_tiles.origin(i);
        // An undecidable bound (NaN) covers the tile: fmin and fmax drop the NaN.
        const auto pixel = [](double x, double if_nan) {
            if (std::isnan(x)) x = if_nan;
            return static_cast<int>(std::floor(std::fmin(std::fmax(x, -1.0), kTileSize)));
        };
        const Rect r = m_tiles.local_pixels(i).intersect(
            {pixel(bounds.x0 - origin.x, 0), pixel(bounds.y0 - origin.y, 0),
             pixel(bounds.x1 - origin.x, kTileSize) + 1,
             pixel(bounds.y1 - origin.y, kTileSize) + 1});
        if (r.empty()) return true;
        // A key at a sample may round a few ulp past the nearest corner's.
        const float limit = bounds.nearest_key + std::fabs(bounds.nearest_key) * 0x1p-20f;
        for (int y = r.y0 / kBlockSide; y <= (r.y1 - 1) / kBlockSide; ++y)
            for (int x = r.x0 / kBlockSide; x <= (r.x1 - 1) / kBlockSide; ++x)
                if (!(limit < m_farthest[i * kBlocks * kBlocks +
                                         static_cast<std::size_t>(y * kBlocks + x)]))
                    return false;
        return true;
    }

    ComputeDevice& m_device;
    HiderFrame m_frame;
    BucketTiles m_tiles;
    TileGrid m_tile_grid;
    std::size_t m_group_size;
    std::vector<TileGroup> m_groups;
    std::vector<float> m_farthest;  ///< [tiles][16]
};

}  // namespace

std::unique_ptr<Hider> make_compute_hider(ComputeDevice& device, const HiderFrame& frame,
                                          const Rect& tiles, const Rect& pixels) {
    return std::make_unique<ComputeHider>(device, frame, tiles, pixels);
}

}  // namespace granita
