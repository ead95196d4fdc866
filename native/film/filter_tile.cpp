// SPDX-License-Identifier: GPL-3.0-or-later
// One tile's samples, weighted into the pixels they reach.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "film/cell_sums.h"
#include "film/filter_samples.h"

namespace granita {

namespace {

/// Where a filter within the pixel meets next to none of its samples, the pixel is what is seen
/// nearest to its centre: what a filter without width would show.
/// @param pixel of the tile.  @param rows channels of the tile's samples.
void take_nearest(const TileSamples& samples, const SampleColors& colors, const float* rows,
                  int pixel, TileSums& sums) {
    const int column = pixel % kTileSize, row = pixel / kTileSize;
    const Vec2f center(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
    const auto distance2 = [&](std::size_t i) {
        const Vec2f d = Vec2f(samples.x[i], samples.y[i]) - center;
        return glm::dot(d, d);
    };
    const std::size_t first = static_cast<std::size_t>(pixel) * samples.samples;
    const std::size_t end = first + static_cast<std::size_t>(samples.samples);
    float least = INFINITY;
    for (std::size_t i = first; i < end; ++i) least = std::min(least, distance2(i));
    float sum[TileSums::kPlanes] = {};
    float* const out = sums.rows.data() + static_cast<std::size_t>(pixel) * sums.width;
    std::fill_n(out, sums.width, 0.0f);
    for (std::size_t i = first; i < end; ++i) {
        if (distance2(i) > 1.0001f * least) continue;  // of a lattice several are as near
        const float values[] = {colors.red[i], colors.green[i], colors.blue[i], colors.alpha[i],
                                1.0f};
        for (int plane = 0; plane < TileSums::kPlanes; ++plane) sum[plane] += values[plane];
        for (std::size_t k = 0; k < sums.width; ++k) out[k] += rows[i * sums.width + k];
    }
    for (int plane = 0; plane < TileSums::kPlanes; ++plane) sums.plane(plane)[pixel] = sum[plane];
}

}  // namespace

TileContribution Film::filter_tile(Vec2i tile, const TileSamples& samples,
                                   const SampleColors& colors,
                                   const SampleChannels* channels) const {
    const int n = samples.samples;
    const std::size_t width = m_channels.sample_width(), center_width = m_channels.center_width();
    GRANITA_CHECK(m_channels.empty() ||
                  (channels &&
                   channels->filtered.size() == colors.size() * width + SampleChannels::kPadding));
    GRANITA_CHECK_EQ(colors.size(), static_cast<std::size_t>(kTileSize * kTileSize) * n);
    const Vec2i corner = tile * kTileSize;
    const Rect tile_pixels{corner.x, corner.y, corner.x + kTileSize, corner.y + kTileSize};
    TileContribution out;
    out.tile = tile;
    const Rect source = tile_pixels.intersect(m_sample_pixels);
    if (source.empty()) return out;
    out.rect = {tile_pixels.x0 - m_each_side, tile_pixels.y0 - m_each_side,
                tile_pixels.x1 + m_each_side, tile_pixels.y1 + m_each_side};
    out.own = tile_pixels.intersect(m_options.crop);
    out.sums = TileSums(m_each_side, width);
    const float* const rows = width > 0 ? channels->filtered.data() : nullptr;
    filter_samples(m_pieces, samples, colors, rows, source.y0 - corner.y, source.y1 - corner.y,
                   out.sums);
    if (m_each_side == 0)
        for (int pixel = 0; pixel < kTileSize * kTileSize; ++pixel)
            if (!(out.sums.plane(TileSums::kWeight)[pixel] > kLeastWeight))
                take_nearest(samples, colors, rows, pixel, out.sums);

    if (out.own.empty() || (!m_options.depth_pass && center_width == 0)) return out;
    const auto centers = m_options.depth_pass ? center_samples(samples) : CenterSamples{};
    for (int y = out.own.y0; y < out.own.y1; ++y)
        for (int x = out.own.x0; x < out.own.x1; ++x) {
            const int p = (y - corner.y) * kTileSize + x - corner.x;
            if (m_options.depth_pass) {
                const float depth = colors.depth[centers[p]];
                out.depth.push_back(std::isfinite(depth) ? depth : kNoDepth);
            }
            if (center_width > 0) {
                const auto row = channels->center.begin() + p * center_width;
                out.center.insert(out.center.end(), row, row + center_width);
            }
        }
    return out;
}

}  // namespace granita
