// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/film.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "film/cell_sums.h"

namespace granita {
namespace {

int floor_div(int a, int b) {
    return a >= 0 ? a / b : -((b - 1 - a) / b);
}
Rect cells_over(const Rect& pixels, int size) {
    return {floor_div(pixels.x0, size), floor_div(pixels.y0, size),
            floor_div(pixels.x1 - 1, size) + 1, floor_div(pixels.y1 - 1, size) + 1};
}
Rect cell_pixels(int x, int y, int size) {
    return {x * size, y * size, (x + 1) * size, (y + 1) * size};
}

/// Pixels of which samples in [x0, x1) can reach the centre; also the other way round: pixels whose
/// samples can reach the centres in [x0, x1).
Rect grown(const Rect& r, int each_side) {
    return {r.x0 - each_side, r.y0 - each_side, r.x1 + each_side, r.y1 + each_side};
}

void accumulate(const float* from, std::size_t count, float* to) {
    for (std::size_t i = 0; i < count; ++i) to[i] += from[i];
}

}  // namespace

/// Output squares that wait for tiles.
struct Film::Pending {
    struct Cell {
        Rect rect;
        int missing = 0;
        std::vector<std::shared_ptr<const TileContribution>> parts;
    };
    Rect cells;
    std::vector<Cell> list;
    Cell& at(int x, int y) { return list[(y - cells.y0) * cells.width() + x - cells.x0]; }
};

Film::~Film() = default;

Film::Film(const Options& options)
    : m_options(options),
      m_channels(options),
      m_filter(options.pixel_filter, options.filter_width),
      m_pieces(m_filter),
      m_each_side(std::max(0, static_cast<int>(std::ceil(m_filter.radius() - 0.5f)))),
      m_sample_pixels(options.crop.empty() ? Rect{} : grown(options.crop, m_each_side)),
      m_pending(std::make_unique<Pending>()) {
    GRANITA_CHECK(options.bucket_size > 0);
    if (options.crop.empty()) return;
    m_pending->cells = cells_over(options.crop, options.bucket_size);
    const Rect& cells = m_pending->cells;
    for (int y = cells.y0; y < cells.y1; ++y)
        for (int x = cells.x0; x < cells.x1; ++x) {
            Pending::Cell& cell = m_pending->list.emplace_back();
            cell.rect = cell_pixels(x, y, options.bucket_size).intersect(options.crop);
            const Rect tiles = cells_over(grown(cell.rect, m_each_side), kTileSize);
            cell.missing = tiles.width() * tiles.height();
        }
}

std::vector<Tile> Film::add(std::vector<TileContribution> contributions) {
    struct Complete {
        Rect rect;
        std::vector<std::shared_ptr<const TileContribution>> parts;
    };
    std::vector<Complete> complete;
    {
        const std::lock_guard lock(m_mutex);
        for (TileContribution& contribution : contributions) {
            if (contribution.rect.intersect(m_options.crop).empty()) continue;
            const auto part = std::make_shared<const TileContribution>(std::move(contribution));
            const Rect cells =
                cells_over(part->rect.intersect(m_options.crop), m_options.bucket_size);
            for (int y = cells.y0; y < cells.y1; ++y)
                for (int x = cells.x0; x < cells.x1; ++x) {
                    Pending::Cell& cell = m_pending->at(x, y);
                    GRANITA_CHECK(cell.missing > 0);
                    cell.parts.push_back(part);
                    if (--cell.missing == 0) complete.push_back({cell.rect, std::move(cell.parts)});
                }
        }
    }
    std::vector<Tile> tiles;
    tiles.reserve(complete.size());
    for (Complete& c : complete) tiles.push_back(finish_cell(c.rect, std::move(c.parts)));
    return tiles;
}

Tile Film::finish_cell(const Rect& cell,
                       std::vector<std::shared_ptr<const TileContribution>> parts) const {
    std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
        return a->tile.y != b->tile.y ? a->tile.y < b->tile.y : a->tile.x < b->tile.x;
    });
    Tile out;
    out.rect = cell;
    const std::size_t count = static_cast<std::size_t>(cell.width()) * cell.height();
    const std::size_t width = m_channels.sample_width(), center_width = m_channels.center_width();
    out.combined.resize(count);
    if (m_options.depth_pass) out.depth.assign(count, kNoDepth);
    CellSums sums;
    sums.planes.assign(count * TileSums::kPlanes, 0.0f);
    sums.channels.assign(count * width, 0.0f);
    sums.center.assign(count * center_width, 0.0f);
    for (const auto& part : parts) {
        const Rect r = part->rect.intersect(cell);
        for (int y = r.y0; y < r.y1; ++y) {
            const std::size_t to = (y - cell.y0) * cell.width() + r.x0 - cell.x0;
            const std::size_t from =
                (y - part->rect.y0) * part->rect.width() + r.x0 - part->rect.x0;
            for (int plane = 0; plane < TileSums::kPlanes; ++plane)
                accumulate(part->sums.plane(plane) + from, r.width(),
                           &sums.planes[plane * count + to]);
            accumulate(part->sums.rows.data() + from * width, r.width() * width,
                       sums.channels.data() + to * width);
        }
        const Rect own = part->own.intersect(cell);
        for (int y = own.y0; y < own.y1; ++y)
            for (int x = own.x0; x < own.x1; ++x) {
                const std::size_t to = (y - cell.y0) * cell.width() + x - cell.x0;
                const std::size_t from = (y - part->own.y0) * part->own.width() + x - part->own.x0;
                if (m_options.depth_pass) out.depth[to] = part->depth[from];
                std::copy_n(part->center.begin() + from * center_width, center_width,
                            sums.center.begin() + to * center_width);
            }
    }
    const auto plane = [&](int which) { return sums.planes.data() + which * count; };
    for (std::size_t i = 0; i < count; ++i) {
        out.combined[i] = Vec4f(plane(TileSums::kRed)[i], plane(TileSums::kGreen)[i],
                                plane(TileSums::kBlue)[i], plane(TileSums::kAlpha)[i]);
        const float weight = plane(TileSums::kWeight)[i];
        if (!(weight > kLeastWeight)) continue;  // then the sum stands
        out.combined[i] /= weight;
        for (std::size_t k = 0; k < width; ++k) sums.channels[i * width + k] /= weight;
    }
    finish_passes(sums, out);
    return out;
}

}  // namespace granita
