// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/bucket_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/object_pool.h"
#include "hider/micropolygon.h"

namespace granita {
namespace {

/// floor(x / tile) within [lo, hi]; infinities clamp, NaN takes `if_nan`.
int clamped_tile(float x, int lo, int hi, int if_nan) {
    if (std::isnan(x)) return if_nan;
    const double tile = std::floor(static_cast<double>(x) / kTileSize);
    return static_cast<int>(std::clamp(tile, static_cast<double>(lo), static_cast<double>(hi)));
}

}  // namespace

DepthRange depth_range(const Projection& p) {
    const auto key = [&](double z) { return static_cast<float>(p.perspective ? 1.0 / z : -z); };
    return {p.perspective, key(p.far_clip), key(p.near_clip)};
}

BucketTiles::BucketTiles(const HiderFrame& frame, const Rect& tiles, const Rect& pixels)
    : m_frame(frame), m_tiles(tiles), m_pixels(pixels), m_list_memory(ObjectPool<Arena>::take()) {
    const SampleNeeds needs{false, frame.projection.has_lens()};
    for (int y = tiles.y0; y < tiles.y1; ++y)
        for (int x = tiles.x0; x < tiles.x1; ++x) {
            check_cancelled();
            TileStore& store = m_stores.emplace_back(ObjectPool<TileStore>::take());
            store.tile = {x, y};
            m_samples.push_back(ObjectPool<TileSamples>::take());
            frame.table->fill_tile(store.tile, needs, m_samples.back());
            store.key.assign(m_samples.back().x.size(), -std::numeric_limits<float>::infinity());
            store.id.assign(m_samples.back().x.size(), kNoSurface);
            store.lists.reset();
        }
    m_needs.assign(m_stores.size(), needs);
    m_left.resize(m_stores.size(), 0);
}

SurfaceId BucketTiles::add(const Grid& grid, const GridClasses& classes) {
    const SurfaceId base = m_pool.add(grid);
    if (!classes.opacity.empty()) m_pool.set_opacity(classes.opacity);
    report_dropped(grid, classes.dropped);
    return base;
}

BucketTiles::~BucketTiles() {
    for (TileStore& store : m_stores) ObjectPool<TileStore>::give(std::move(store));
    m_list_memory.clear();
    ObjectPool<Arena>::give(std::move(m_list_memory));
    for (TileSamples& samples : m_samples) ObjectPool<TileSamples>::give(std::move(samples));
}

void BucketTiles::check_cancelled() const {
    if (m_frame.progress) m_frame.progress->check();
}

Rect BucketTiles::touched(const RasterBounds& b) const {
    if (!b.visible || b.x1 < static_cast<float>(m_pixels.x0) ||
        b.y1 < static_cast<float>(m_pixels.y0) || b.x0 > static_cast<float>(m_pixels.x1) ||
        b.y0 > static_cast<float>(m_pixels.y1))
        return {};
    return {clamped_tile(b.x0, m_tiles.x0, m_tiles.x1 - 1, m_tiles.x0),
            clamped_tile(b.y0, m_tiles.y0, m_tiles.y1 - 1, m_tiles.y0),
            clamped_tile(b.x1, m_tiles.x0, m_tiles.x1 - 1, m_tiles.x1 - 1) + 1,
            clamped_tile(b.y1, m_tiles.y0, m_tiles.y1 - 1, m_tiles.y1 - 1) + 1};
}

Rect BucketTiles::local_pixels(std::size_t i) const {
    const Vec2i corner = m_stores[i].tile * kTileSize;
    return Rect{0, 0, kTileSize, kTileSize}.intersect(
        {m_pixels.x0 - corner.x, m_pixels.y0 - corner.y, m_pixels.x1 - corner.x,
         m_pixels.y1 - corner.y});
}

void BucketTiles::need_time(std::size_t i) {
    if (m_needs[i].time) return;
    m_needs[i].time = true;
    m_frame.table->fill_times(m_stores[i].tile, m_samples[i]);
}

void BucketTiles::drop_samples() {
    for (TileSamples& samples : m_samples) ObjectPool<TileSamples>::give(std::move(samples));
    m_samples.clear();
}

void BucketTiles::make_samples() {
    for (std::size_t i = m_samples.size(); i < m_stores.size(); ++i) {
        m_samples.push_back(ObjectPool<TileSamples>::take());
        m_frame.table->fill_tile(m_stores[i].tile, m_needs[i], m_samples.back());
    }
}

bool BucketTiles::limit_lists() {
    const std::uint64_t bytes = m_list_memory.bytes();
    if (m_frame.statistics) m_frame.statistics->note_list_bytes(bytes);
    m_overflowed = m_overflowed || bytes > m_frame.list_bytes;
    return m_overflowed;
}

bool BucketTiles::lists_grew(std::size_t i) const {
    return worth_cutting(m_stores[i].lists.total(), m_left[i], m_stores[i].key.size());
}

void BucketTiles::cut_lists(std::size_t i, const ListEnd& end) {
    TileStore& store = m_stores[i];
    sort_lists(store.lists, surfaces_of(store), m_pool, end);
    m_left[i] = store.lists.total();
}

void BucketTiles::clear_lists() {
    for (TileStore& store : m_stores) store.lists.clear();
}

void BucketTiles::finish_lists(std::size_t i, const OpaqueSurfaces& surfaces, const ListEnd& end) {
    m_listed.resize(m_pool.id_end(), 0);
    sort_lists(m_stores[i].lists, surfaces, m_pool, end, m_listed.data());
}

std::vector<bool> BucketTiles::seen_grids() const {
    // A mark for each micropolygon, and one for nothing: no question a sample.
    const SurfaceId end = m_pool.id_end();
    std::vector<char> marks = m_listed;
    marks.resize(static_cast<std::size_t>(end) + 1, 0);
    for (const TileStore& store : m_stores)
        for (const SurfaceId id : store.id) marks[std::min(id, end)] = 1;
    std::vector<bool> seen(m_pool.size(), false);
    auto next = marks.begin();
    for (std::uint32_t slot = 0; slot < m_pool.size(); ++slot) {
        const auto first = next;
        next += m_pool.grid(slot).micropolygon_count();
        seen[slot] = std::find(first, next, 1) != next;
    }
    return seen;
}

void BucketTiles::report_dropped(const Grid& grid, std::uint64_t dropped) const {
    if (dropped == 0) return;
    if (m_frame.statistics) m_frame.statistics->add(Counter::MicropolygonsDropped, dropped);
    if (m_frame.report && m_frame.scene)
        m_frame.report->warn("object '" + m_frame.scene->instances.at(grid.instance).name + "'",
                             "micropolygons with a vertex that is not finite were left out",
                             dropped);
}

}  // namespace granita
