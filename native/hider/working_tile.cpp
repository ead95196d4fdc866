// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/working_tile.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace granita {
namespace {

constexpr int kPixels = kTileSize * kTileSize;
constexpr int kMaxCells = 256;

}  // namespace

WorkingTile::WorkingTile(const TileSamples& samples, const Rect& pixels, Vec2f lens,
                         float lens_reach)
    : blocks(pixels),
      m_samples(samples.samples),
      m_pixels(pixels),
      m_lens(lens),
      m_lens_reach(lens_reach),
      m_cells(std::min(samples.samples, kMaxCells)) {
    m_order.resize(samples.x.size());
    std::iota(m_order.begin(), m_order.end(), 0u);
    copy(samples.x, 1.0f, m_x);
    copy(samples.y, 1.0f, m_y);
    copy(samples.u, m_lens.x, m_u);
    copy(samples.v, m_lens.y, m_v);
    m_key.assign(samples.x.size() + kLanePadding, -INFINITY);
    m_id.assign(samples.x.size() + kLanePadding, kNoSurface);
}

void WorkingTile::copy(const std::vector<float>& from, float factor, std::vector<float>& to) const {
    to.assign(from.size() + kLanePadding, 0.0f);
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[m_order[i]] * factor;
}

// Counting sort of every pixel's samples into cells; stable, so the order is a function of the
// table alone.
void WorkingTile::order_by(const std::vector<int>& cell) {
    m_cell_start.assign(static_cast<std::size_t>(kPixels) * (m_cells + 1), 0);
    std::vector<std::uint32_t> next(m_cells);
    for (int pixel = 0; pixel < kPixels; ++pixel) {
        const std::size_t first = static_cast<std::size_t>(pixel) * m_samples;
        std::uint32_t* const start = &m_cell_start[static_cast<std::size_t>(pixel) * (m_cells + 1)];
        for (int s = 0; s < m_samples; ++s) ++start[cell[first + s] + 1];
        for (int c = 0; c < m_cells; ++c) start[c + 1] += start[c];
        std::copy(start, start + m_cells, next.begin());
        for (int s = 0; s < m_samples; ++s)
            m_order[first + next[cell[first + s]]++] = static_cast<std::uint32_t>(first + s);
    }
}

void WorkingTile::sort(SortedBy by, const TileSamples& samples) {
    const std::size_t count = samples.x.size();
    const auto cells = static_cast<float>(m_cells);
    std::vector<int> cell(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float place = by == SortedBy::Time
                                ? samples.t[i]
                                : 0.5f + 0.5f * (samples.u[i] * m_lens.x / m_lens_reach);
        cell[i] = std::clamp(static_cast<int>(place * cells), 0, m_cells - 1);
    }
    const std::vector<std::uint32_t> before = m_order;
    order_by(cell);
    m_sorted_by = by;
    copy(samples.x, 1.0f, m_x);
    copy(samples.y, 1.0f, m_y);
    copy(samples.t, 1.0f, m_t);
    copy(samples.u, m_lens.x, m_u);
    copy(samples.v, m_lens.y, m_v);

    std::vector<std::uint32_t> old_place(count), new_place(count);  // by index in the table
    for (std::uint32_t i = 0; i < count; ++i) {
        old_place[before[i]] = i;
        new_place[m_order[i]] = i;
    }
    const std::vector<float> key = m_key;
    const std::vector<SurfaceId> id = m_id;
    for (std::size_t i = 0; i < count; ++i) {
        m_key[i] = key[old_place[m_order[i]]];
        m_id[i] = id[old_place[m_order[i]]];
    }
    for (Fragment& fragment : fragments) fragment.sample = new_place[before[fragment.sample]];
}

SimdTile WorkingTile::view() {
    SimdTile tile;
    tile.samples = m_samples;
    tile.x = m_x.data();
    tile.y = m_y.data();
    tile.t = m_t.data();
    tile.u = m_u.data();
    tile.v = m_v.data();
    tile.key = m_key.data();
    tile.id = m_id.data();
    tile.sorted_by = m_sorted_by;
    tile.cell_start = m_cell_start.data();
    tile.cells = m_cells;
    tile.pixels = m_pixels;
    return tile;
}

void WorkingTile::store(TileStore& out) const {
    for (std::size_t i = 0; i < out.key.size(); ++i) {
        out.key[m_order[i]] = m_key[i];
        out.id[m_order[i]] = m_id[i];
    }
    out.fragments = fragments;
    for (Fragment& fragment : out.fragments) fragment.sample = m_order[fragment.sample];
}

}  // namespace granita
