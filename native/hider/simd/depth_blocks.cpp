// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/depth_blocks.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// Squares of strata are this wide, pixels, unless blocks are wider.
constexpr int kSquare = 4;

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

void DepthBlocks::reset(const SampleOrder& order, const StratumBounds& bounds) {
    m_bounds = &bounds;
    m_packets = &order.packets();
    m_blocks_wide = order.blocks_wide();
    m_strata = order.strata();
    m_stratum_stride = order.stratum_stride();
    m_stratified = order.shape().stratified;
    m_writes = 0;
    m_square_shift = 0;
    while ((m_blocks_wide >> m_square_shift) > kTileSize / kSquare) ++m_square_shift;
    const std::size_t blocks = static_cast<std::size_t>(m_blocks_wide) * m_blocks_wide;
    const std::size_t squares = static_cast<std::size_t>(squares_wide()) * squares_wide();
    m_packet.assign(m_stratified ? 0 : blocks * (m_strata / kPacket), -INFINITY);
    // Strata are read in whole vectors.
    m_stratum.assign(m_stratified ? squares * m_strata + kPacket : 0, -INFINITY);
    m_block.assign(blocks, -INFINITY);
    m_tile = m_nearest_stratum = -INFINITY;
    m_filled = false;
}

void DepthBlocks::update(const float* keys) {
    // An eighth of the samples: a scan costs about as much as hiding that many.
    if (m_writes >= m_block.size() * m_strata / 8) rebuild(keys);
}

void DepthBlocks::rebuild(const float* keys) {
    m_writes = 0;
    m_filled = true;
    m_stratified ? rebuild_strata(keys) : rebuild_packets(keys);
    m_tile = *std::min_element(m_block.begin(), m_block.end());
}

void DepthBlocks::rebuild_packets(const float* keys) {
    for (std::size_t p = 0; p < m_packet.size(); ++p)
        m_packet[p] = least_of_packet(keys + p * kPacket);
    const std::uint32_t* packet = m_packets->data();
    for (float& block : m_block) {
        block = INFINITY;
        for (int i = 0; i < m_strata; i += kPacket) block = std::min(block, m_packet[*packet++]);
    }
}

void DepthBlocks::rebuild_strata(const float* keys) {
    std::fill(m_block.begin(), m_block.end(), INFINITY);
    const int wide = m_blocks_wide, square = 1 << m_square_shift;
    // Rows of blocks one by one, in vectors; only then the columns of each square.
    std::vector<float> least(static_cast<std::size_t>(wide));
    for (int r = 0; r < m_strata; ++r)
        for (int square_y = 0; square_y < squares_wide(); ++square_y) {
            std::fill(least.begin(), least.end(), INFINITY);
            float* block = &m_block[static_cast<std::size_t>(square_y) * square * wide];
            const float* row = &keys[r * m_stratum_stride + (block - m_block.data())];
            for (int y = 0; y < square; ++y, block += wide, row += wide)
                for (int x = 0; x < wide; ++x) {
                    block[x] = std::min(block[x], row[x]);
                    least[x] = std::min(least[x], row[x]);
                }
            for (int square_x = 0; square_x < squares_wide(); ++square_x) {
                float farthest = INFINITY;
                for (int x = square_x * square; x < (square_x + 1) * square; ++x)
                    farthest = std::min(farthest, least[x]);
                const auto at = static_cast<std::size_t>(square_y) * squares_wide() + square_x;
                m_stratum[at * m_strata + r] = farthest;
            }
        }
    m_nearest_stratum = *std::max_element(m_stratum.begin(), m_stratum.end() - kPacket);
}

bool DepthBlocks::hide_in_square(std::size_t square, float time0, float time1, float limit) const {
    for (int r = 0; r < m_strata; ++r)
        if (m_bounds->t_lo[r] <= time1 && m_bounds->t_hi[r] >= time0 &&
            !(limit < m_stratum[square * m_strata + r]))
            return false;
    return true;
}

bool DepthBlocks::hide(const Rect& pixels, float time0, float time1, float nearest_key) const {
    if (pixels.empty()) return true;
    // A key at a sample may round a few ulp past the nearest corner's.
    const float limit = nearest_key + std::fabs(nearest_key) * 0x1p-20f;
    if (limit < m_tile) return true;
    const bool always = !m_stratified || (time0 <= 0.0f && time1 >= 1.0f);
    const int wide = always ? m_blocks_wide : squares_wide();
    const double per_pixel = static_cast<double>(wide) / kTileSize;
    const auto first = [&](int pixel) { return static_cast<int>(pixel * per_pixel); };
    const auto end = [&](int pixel) { return static_cast<int>(std::ceil(pixel * per_pixel)); };
    for (int y = first(pixels.y0); y < end(pixels.y1); ++y)
        for (int x = first(pixels.x0); x < end(pixels.x1); ++x) {
            const auto at = static_cast<std::size_t>(y) * wide + x;
            if (always ? !(limit < m_block[at]) : !hide_in_square(at, time0, time1, limit))
                return false;
        }
    return true;
}

}  // namespace granita
