// SPDX-License-Identifier: GPL-3.0-or-later
// One tile's samples, weighted into the pixels they reach.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "film/film.h"

namespace granita {
namespace {

/// Sums run in this many lanes, in a fixed order: the same bits whatever the compiler vectorises.
constexpr int kLanes = 8;

/// A pixel's samples, structure of arrays, padded with zeros to whole lanes.
struct PixelSamples {
    explicit PixelSamples(int samples)
        : padded((samples + kLanes - 1) / kLanes * kLanes),
          r(padded),
          g(padded),
          b(padded),
          a(padded) {}
    std::size_t padded;
    std::vector<float> r, g, b, a;
};

struct Sum {
    float r[kLanes] = {}, g[kLanes] = {}, b[kLanes] = {}, a[kLanes] = {}, w[kLanes] = {};
};

float total(const float* lanes) {
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
           ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

Sum weigh(const PixelSamples& p, const float* wx, const float* wy) {
    Sum sum;
    for (std::size_t i = 0; i < p.padded; i += kLanes)
        for (int lane = 0; lane < kLanes; ++lane) {
            const float w = wx[i + lane] * wy[i + lane];
            sum.r[lane] += w * p.r[i + lane];
            sum.g[lane] += w * p.g[i + lane];
            sum.b[lane] += w * p.b[i + lane];
            sum.a[lane] += w * p.a[i + lane];
            sum.w[lane] += w;
        }
    return sum;
}

}  // namespace

TileContribution Film::filter_tile(Vec2i tile, const TileSamples& samples,
                                   const std::vector<SampleColor>& colors) const {
    const int n = samples.samples;
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

    const float radius = m_filter.radius();
    const int taps_each_side = std::max(0, static_cast<int>(std::ceil(radius - 0.5f)));
    const int taps = 2 * taps_each_side + 1;
    PixelSamples pixel(n);
    std::vector<float> wx(taps * pixel.padded, 0.0f), wy(taps * pixel.padded, 0.0f);
    const float to_table = static_cast<float>(m_table.size() - 2) / radius;
    const auto factor = [&](float d) {
        if (m_filter.is_box()) return m_filter.evaluate(d);
        const float place = std::fabs(d) * to_table;
        if (!(place < static_cast<float>(m_table.size() - 2))) return 0.0f;
        const auto cell = static_cast<std::size_t>(place);
        return m_table[cell] +
               (place - static_cast<float>(cell)) * (m_table[cell + 1] - m_table[cell]);
    };

    const Rect source = tile_pixels.intersect(m_sample_pixels);
    const float share = 1.0f / static_cast<float>(n);
    for (int y = source.y0; y < source.y1; ++y)
        for (int x = source.x0; x < source.x1; ++x) {
            const int local_x = x - corner.x, local_y = y - corner.y;
            const std::size_t first = static_cast<std::size_t>(local_y * kTileSize + local_x) * n;
            for (int s = 0; s < n; ++s) {
                const SampleColor& c = colors[first + s];
                pixel.r[s] = c.color.x;
                pixel.g[s] = c.color.y;
                pixel.b[s] = c.color.z;
                pixel.a[s] = c.alpha;
                // Distance from the centre of the pixel that is `tap - taps_each_side` away.
                const float dx = samples.x[first + s] - (static_cast<float>(local_x) + 0.5f);
                const float dy = samples.y[first + s] - (static_cast<float>(local_y) + 0.5f);
                for (int tap = 0; tap < taps; ++tap) {
                    const auto step = static_cast<float>(tap - taps_each_side);
                    wx[tap * pixel.padded + s] = factor(dx - step) * share;
                    wy[tap * pixel.padded + s] = factor(dy - step);
                }
            }
            for (int ty = 0; ty < taps; ++ty)
                for (int tx = 0; tx < taps; ++tx) {
                    const int to_x = x + tx - taps_each_side, to_y = y + ty - taps_each_side;
                    if (to_x < out.rect.x0 || to_x >= out.rect.x1 || to_y < out.rect.y0 ||
                        to_y >= out.rect.y1)
                        continue;
                    const Sum sum = weigh(pixel, &wx[tx * pixel.padded], &wy[ty * pixel.padded]);
                    const std::size_t to =
                        (to_y - out.rect.y0) * out.rect.width() + to_x - out.rect.x0;
                    out.sum[to] += Vec4f(total(sum.r), total(sum.g), total(sum.b), total(sum.a));
                    out.weight[to] += total(sum.w);
                }
        }

    if (!m_options.depth_pass || out.own.empty()) return out;
    for (int y = out.own.y0; y < out.own.y1; ++y)
        for (int x = out.own.x0; x < out.own.x1; ++x) {
            const std::size_t first =
                static_cast<std::size_t>((y - corner.y) * kTileSize + x - corner.x) * n;
            std::size_t nearest = first;
            float least = INFINITY;
            for (std::size_t i = first; i < first + n; ++i) {
                const float dx = samples.x[i] - (static_cast<float>(x - corner.x) + 0.5f);
                const float dy = samples.y[i] - (static_cast<float>(y - corner.y) + 0.5f);
                if (dx * dx + dy * dy < least) {
                    least = dx * dx + dy * dy;
                    nearest = i;
                }
            }
            const float depth = colors[nearest].depth;
            out.depth.push_back(std::isfinite(depth) ? depth : kNoDepth);
        }
    return out;
}

}  // namespace granita
