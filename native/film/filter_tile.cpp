// SPDX-License-Identifier: GPL-3.0-or-later
// One tile's samples, weighted into the pixels they reach.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "film/cell_sums.h"
#include "film/weigh_pixel.h"

namespace granita {

namespace {

/// Adds the sums for the pixels `to` to those of them that the contribution holds.
void add_sums(const PixelWork& work, const Rect& to, TileContribution& out) {
    const Rect inside = to.intersect(out.rect);
    const auto width = static_cast<std::size_t>(work.width);
    for (int y = inside.y0; y < inside.y1; ++y)
        for (int x = inside.x0; x < inside.x1; ++x) {
            const std::size_t tap = (y - to.y0) * work.taps + x - to.x0;
            const std::size_t pixel = (y - out.rect.y0) * out.rect.width() + x - out.rect.x0;
            const WeightedSum& sum = work.sums[tap];
            out.sum[pixel] += Vec4f(sum.r, sum.g, sum.b, sum.a);
            out.weight[pixel] += sum.weight;
            for (std::size_t k = 0; k < width; ++k)
                out.channel_sum[pixel * width + k] += work.row_sums[tap * width + k];
        }
}

/// Where a filter within the pixel meets next to none of its samples, the pixel is what is seen
/// nearest to its centre: what a filter without width would show.
void take_nearest(PixelWork& work) {
    const auto distance2 = [&](int i) {
        const Vec2f d = Vec2f(work.x[i], work.y[i]) - work.center;
        return glm::dot(d, d);
    };
    float least = INFINITY;
    for (int i = 0; i < work.samples; ++i) least = std::min(least, distance2(i));
    WeightedSum& sum = work.sums.front() = {};
    std::fill(work.row_sums.begin(), work.row_sums.end(), 0.0f);
    const auto width = static_cast<std::size_t>(work.width);
    for (int i = 0; i < work.samples; ++i) {
        if (distance2(i) > 1.0001f * least) continue;  // of a lattice several are as near
        sum.r += work.red[i];
        sum.g += work.green[i];
        sum.b += work.blue[i];
        sum.a += work.alpha[i];
        sum.weight += 1.0f;
        const float* const row = work.rows + static_cast<std::size_t>(i) * width;
        for (std::size_t k = 0; k < width; ++k) work.row_sums[k] += row[k];
    }
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
    out.rect = reach(tile);
    out.own = tile_pixels.intersect(m_options.crop);
    if (out.rect.empty()) return out;
    const std::size_t reached = static_cast<std::size_t>(out.rect.width()) * out.rect.height();
    out.sum.assign(reached, Vec4f(0.0f));
    out.weight.assign(reached, 0.0f);
    out.channel_sum.assign(reached * width, 0.0f);

    const float radius = m_filter.radius();
    const int each_side = std::max(0, static_cast<int>(std::ceil(radius - 0.5f)));
    const float share = 1.0f / static_cast<float>(n);
    PixelWork work(n, each_side, static_cast<int>(width));
    const Rect source = tile_pixels.intersect(m_sample_pixels);
    for (int y = source.y0; y < source.y1; ++y)
        for (int x = source.x0; x < source.x1; ++x) {
            const int local_x = x - corner.x, local_y = y - corner.y;
            const std::size_t first = static_cast<std::size_t>(local_y * kTileSize + local_x) * n;
            work.load(samples, colors, first,
                      {static_cast<float>(local_x) + 0.5f, static_cast<float>(local_y) + 0.5f},
                      width > 0 ? &channels->filtered[first * width] : nullptr);
            weigh_pixel(m_pieces, share, work);
            if (each_side == 0 && !(work.sums.front().weight > kLeastWeight)) take_nearest(work);
            const Rect reached_pixels{x - each_side, y - each_side, x + each_side + 1,
                                      y + each_side + 1};
            add_sums(work, reached_pixels, out);
        }

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
