// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/depth_blocks.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// Least of `count` values; lanes, because the order of minima does not matter but vectors do.
float least_of(const float* values, std::size_t count, float least) {
    float lanes[8];
    std::fill(lanes, lanes + 8, least);
    std::size_t i = 0;
    for (; i + 8 <= count; i += 8)
        for (int lane = 0; lane < 8; ++lane)
            lanes[lane] = values[i + lane] < lanes[lane] ? values[i + lane] : lanes[lane];
    for (; i < count; ++i) lanes[0] = std::min(lanes[0], values[i]);
    return *std::min_element(lanes, lanes + 8);
}

}  // namespace

DepthBlocks::DepthBlocks(const Rect& pixels) : m_pixels(pixels) {
    m_farthest.fill(-INFINITY);
}

void DepthBlocks::update(const float* keys, int samples) {
    // An eighth of the samples: a scan costs about as much as hiding that many.
    const auto all = static_cast<std::uint64_t>(m_pixels.width()) * m_pixels.height() * samples;
    if (m_writes == 0 || m_writes < all / 8) return;
    m_writes = 0;
    for (int by = 0; by < kBlocks; ++by)
        for (int bx = 0; bx < kBlocks; ++bx) {
            const Rect block =
                Rect{bx * kSide, by * kSide, (bx + 1) * kSide, (by + 1) * kSide}.intersect(
                    m_pixels);
            float least = INFINITY;
            for (int y = block.y0; y < block.y1 && !block.empty(); ++y)
                least =
                    least_of(keys + static_cast<std::size_t>(y * kTileSize + block.x0) * samples,
                             static_cast<std::size_t>(block.width()) * samples, least);
            m_farthest[by * kBlocks + bx] = least;
        }
}

bool DepthBlocks::hide(const Rect& pixels, float nearest_key) const {
    const Rect r = pixels.intersect(m_pixels);
    if (r.empty()) return true;
    // A key at a sample may round a few ulp past the nearest corner's.
    const float limit = nearest_key + std::fabs(nearest_key) * 0x1p-20f;
    for (int by = r.y0 / kSide; by <= (r.y1 - 1) / kSide; ++by)
        for (int bx = r.x0 / kSide; bx <= (r.x1 - 1) / kSide; ++bx)
            if (!(limit < m_farthest[by * kBlocks + bx])) return false;
    return true;
}

}  // namespace granita
