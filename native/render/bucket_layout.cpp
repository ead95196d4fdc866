// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/bucket_layout.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "hider/samples/sample_table.h"

namespace granita {
namespace {

int floor_div(int a, int b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}
int ceil_div(int a, int b) {
    return -floor_div(-a, b);
}

/// floor(x / size) clamped to [lo, hi]; infinities clamp too.
int clamped_cell(float x, int size, int lo, int hi) {
    const double cell = std::floor(static_cast<double>(x) / size);
    return static_cast<int>(std::clamp(cell, static_cast<double>(lo), static_cast<double>(hi)));
}

}  // namespace

BucketLayout::BucketLayout(const Rect& pixels, int bucket_size, int margin, int around)
    : m_pixels(pixels), m_size(bucket_size), m_margin(margin), m_around(around) {
    GRANITA_CHECK_EQ(bucket_size % kTileSize, 0);
    m_buckets = {floor_div(m_pixels.x0, m_size), floor_div(m_pixels.y0, m_size),
                 ceil_div(m_pixels.x1, m_size), ceil_div(m_pixels.y1, m_size)};
}

Rect BucketLayout::pixels(int index) const {
    const Vec2i at = place(index) * m_size;
    return Rect{at.x, at.y, at.x + m_size, at.y + m_size}.intersect(m_pixels);
}

Rect BucketLayout::reach(int index) const {
    const Rect p = pixels(index);
    return {p.x0 - m_margin, p.y0 - m_margin, p.x1 + m_margin, p.y1 + m_margin};
}

Rect BucketLayout::tiles(int index) const {
    const Rect p = pixels(index);
    return {floor_div(p.x0, kTileSize), floor_div(p.y0, kTileSize), ceil_div(p.x1, kTileSize),
            ceil_div(p.y1, kTileSize)};
}

Rect BucketLayout::range(const RasterBounds& bounds) const {
    const auto margin = static_cast<float>(m_margin + m_around);
    const float x0 = bounds.x0 - margin, y0 = bounds.y0 - margin, x1 = bounds.x1 + margin,
                y1 = bounds.y1 + margin;
    // Written so that NaN is outside.
    const bool inside =
        x1 >= static_cast<float>(m_pixels.x0) && y1 >= static_cast<float>(m_pixels.y0) &&
        x0 <= static_cast<float>(m_pixels.x1) && y0 <= static_cast<float>(m_pixels.y1);
    if (!bounds.visible || !inside) return {};
    return {clamped_cell(x0, m_size, m_buckets.x0, m_buckets.x1 - 1),
            clamped_cell(y0, m_size, m_buckets.y0, m_buckets.y1 - 1),
            clamped_cell(x1, m_size, m_buckets.x0, m_buckets.x1 - 1) + 1,
            clamped_cell(y1, m_size, m_buckets.y0, m_buckets.y1 - 1) + 1};
}

std::vector<int> BucketLayout::spiral() const {
    std::vector<int> order;
    order.reserve(static_cast<std::size_t>(count()));
    int x = (m_buckets.x0 + m_buckets.x1 - 1) / 2, y = (m_buckets.y0 + m_buckets.y1 - 1) / 2;
    // Legs of length 1, 1, 2, 2, 3, 3, ...: right, up, left, down.
    const int dx[] = {1, 0, -1, 0}, dy[] = {0, 1, 0, -1};
    for (int leg = 0; static_cast<int>(order.size()) < count(); ++leg) {
        for (int step = 0; step <= leg / 2; ++step) {
            if (x >= m_buckets.x0 && x < m_buckets.x1 && y >= m_buckets.y0 && y < m_buckets.y1)
                order.push_back(index(x, y));
            x += dx[leg % 4];
            y += dy[leg % 4];
        }
    }
    return order;
}

}  // namespace granita
