// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/working_tile.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

constexpr int kPixels = kTileSize * kTileSize;
constexpr int kMaxTimeCells = 256;

}  // namespace

WorkingTile::WorkingTile(const TileSamples& samples, const Rect& pixels, float lens_x, float lens_y)
    : blocks(pixels), m_samples(samples.samples), m_pixels(pixels) {
    copy(samples.x, 1.0f, m_x);
    copy(samples.y, 1.0f, m_y);
    copy(samples.u, lens_x, m_u);
    copy(samples.v, lens_y, m_v);
    m_key.assign(samples.x.size() + kLanePadding, -INFINITY);
    m_id.assign(samples.x.size() + kLanePadding, kNoSurface);
}

void WorkingTile::copy(const std::vector<float>& from, float factor, std::vector<float>& to) const {
    to.assign(from.size() + kLanePadding, 0.0f);
    for (std::size_t i = 0; i < from.size(); ++i)
        to[i] = from[m_order.empty() ? i : m_order[i]] * factor;
}

void WorkingTile::sort_by_time(const TileSamples& samples, float lens_x, float lens_y) {
    // Counting sort of every pixel's samples into time cells; stable, so the order is a function of
    // the table alone.
    m_time_cells = std::min(m_samples, kMaxTimeCells);
    const auto cell = [&](float t) {
        return std::min(static_cast<int>(t * static_cast<float>(m_time_cells)), m_time_cells - 1);
    };
    m_order.resize(samples.t.size());
    m_time_start.assign(static_cast<std::size_t>(kPixels) * (m_time_cells + 1), 0);
    std::vector<std::uint32_t> next(m_time_cells);
    for (int pixel = 0; pixel < kPixels; ++pixel) {
        const std::size_t first = static_cast<std::size_t>(pixel) * m_samples;
        std::uint32_t* const start =
            &m_time_start[static_cast<std::size_t>(pixel) * (m_time_cells + 1)];
        for (int s = 0; s < m_samples; ++s) ++start[cell(samples.t[first + s]) + 1];
        for (int c = 0; c < m_time_cells; ++c) start[c + 1] += start[c];
        std::copy(start, start + m_time_cells, next.begin());
        for (int s = 0; s < m_samples; ++s)
            m_order[first + next[cell(samples.t[first + s])]++] =
                static_cast<std::uint32_t>(first + s);
    }

    copy(samples.x, 1.0f, m_x);
    copy(samples.y, 1.0f, m_y);
    copy(samples.t, 1.0f, m_t);
    copy(samples.u, lens_x, m_u);
    copy(samples.v, lens_y, m_v);
    const std::vector<float> key = m_key;
    const std::vector<SurfaceId> id = m_id;
    std::vector<std::uint32_t> place(m_order.size());
    for (std::uint32_t i = 0; i < m_order.size(); ++i) {
        m_key[i] = key[m_order[i]];
        m_id[i] = id[m_order[i]];
        place[m_order[i]] = i;
    }
    for (Fragment& fragment : fragments) fragment.sample = place[fragment.sample];
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
    tile.time_start = m_time_start.data();
    tile.time_cells = m_time_cells;
    tile.pixels = m_pixels;
    return tile;
}

void WorkingTile::store(TileStore& out) const {
    for (std::size_t i = 0; i < out.key.size(); ++i) {
        const std::size_t to = m_order.empty() ? i : m_order[i];
        out.key[to] = m_key[i];
        out.id[to] = m_id[i];
    }
    out.fragments = fragments;
    if (m_order.empty()) return;
    for (Fragment& fragment : out.fragments) fragment.sample = m_order[fragment.sample];
}

}  // namespace granita
