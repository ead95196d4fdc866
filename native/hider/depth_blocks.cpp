// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/depth_blocks.h"

#include <algorithm>
#include <cmath>

#include "hider/sample_order.h"

namespace granita {
namespace {

/// Least of a packet's keys; lanes, because the order of minima does not matter but vectors do.
float least_of_packet(const float* keys) {
    float lanes[4];
    for (int lane = 0; lane < 4; ++lane) {
        const float a = std::min(keys[lane], keys[lane + 4]);
        const float b = std::min(keys[lane + 8], keys[lane + 12]);
        lanes[lane] = std::min(a, b);
    }
    return std::min(std::min(lanes[0], lanes[1]), std::min(lanes[2], lanes[3]));
}
static_assert(kPacket == 16);

}  // namespace

void DepthBlocks::reset(int blocks_wide, int packets, const PacketBounds& bounds) {
    m_blocks_wide = blocks_wide;
    m_packets = packets;
    m_bounds = &bounds;
    m_writes = 0;
    const std::size_t blocks = static_cast<std::size_t>(blocks_wide) * blocks_wide;
    m_packet.assign(blocks * packets, -INFINITY);
    m_block.assign(blocks, -INFINITY);
    m_tile = -INFINITY;
    m_filled = false;
}

void DepthBlocks::update(const float* keys) {
    // An eighth of the samples: a scan costs about as much as hiding that many.
    if (m_writes >= m_packet.size() * kPacket / 8) rebuild(keys);
}

void DepthBlocks::rebuild(const float* keys) {
    m_writes = 0;
    m_filled = true;
    for (std::size_t p = 0; p < m_packet.size(); ++p)
        m_packet[p] = least_of_packet(keys + p * kPacket);
    for (std::size_t b = 0; b < m_block.size(); ++b)
        m_block[b] =
            *std::min_element(&m_packet[b * m_packets], &m_packet[b * m_packets] + m_packets);
    m_tile = *std::min_element(m_block.begin(), m_block.end());
}

bool DepthBlocks::hide_in_block(std::size_t block, float time0, float time1, float limit) const {
    if (limit < m_block[block]) return true;
    if (time0 <= 0.0f && time1 >= 1.0f) return false;
    for (int k = 0; k < m_packets; ++k)
        if (m_bounds->t_lo[k] <= time1 && m_bounds->t_hi[k] >= time0 &&
            !(limit < m_packet[block * m_packets + k]))
            return false;
    return true;
}

bool DepthBlocks::hide(const Rect& pixels, float time0, float time1, float nearest_key) const {
    if (pixels.empty()) return true;
    // A key at a sample may round a few ulp past the nearest corner's.
    const float limit = nearest_key + std::fabs(nearest_key) * 0x1p-20f;
    if (limit < m_tile) return true;
    const double per_pixel = static_cast<double>(m_blocks_wide) / kTileSize;
    const auto first = [&](int pixel) { return static_cast<int>(pixel * per_pixel); };
    const auto end = [&](int pixel) { return static_cast<int>(std::ceil(pixel * per_pixel)); };
    for (int by = first(pixels.y0); by < end(pixels.y1); ++by)
        for (int bx = first(pixels.x0); bx < end(pixels.x1); ++bx)
            if (!hide_in_block(static_cast<std::size_t>(by) * m_blocks_wide + bx, time0, time1,
                               limit))
                return false;
    return true;
}

}  // namespace granita
