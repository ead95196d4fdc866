// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/compute/compute_batch.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "hider/micropolygon_class.h"
#include "hider/samples/sample_table.h"

namespace granita {
namespace {

constexpr int kBlockSide = 4, kBlocks = kTileSize / kBlockSide;
constexpr std::size_t kBlocksOfTile = kBlocks * kBlocks;

/// When the grid exists, ends included: what lies just before a half-open interval's end belongs to
/// it.  Anything for what is always there, whose entries may mean a lens coordinate.
Interval life_of(const SimdGrid& grid) {
    if (grid.lifespan.is_whole()) return {};
    return {grid.lifespan.open, std::nextafter(grid.lifespan.close, -INFINITY)};
}

/// Those of a segment after each other: they share vertices.
std::vector<PartSegment> parts_by_segment(const SimdGrid& grid) {
    std::vector<PartSegment> parts(grid.parts.begin(), grid.parts.end());
    std::stable_sort(parts.begin(), parts.end(), [](const PartSegment& a, const PartSegment& b) {
        return a.segment < b.segment;
    });
    return parts;
}

}  // namespace

void ComputeBatch::add(const SimdGrid& grid, std::uint32_t tile, const Rect& pixels,
                       const std::function<void()>& run) {
    constexpr std::uint32_t kNotYet = ~std::uint32_t{0};
    const std::size_t vertices = static_cast<std::size_t>(grid.vertices) * (grid.segments ? 2 : 1);
    if (vertices * sizeof(Vec4f) > m_limits.buffer_bytes)
        throw GlError("a grid of " + std::to_string(grid.vertices) +
                      " vertices is too big for the compute executor");
    const Interval life = life_of(grid);
    int segment = 0;
    std::uint32_t first_vertex = kNotYet;  // of the segment
    for (const PartSegment& at : parts_by_segment(grid)) {
        if (at.segment != segment) first_vertex = kNotYet;
        segment = at.segment;
        const GridPart& part = at.part;
        for (int k = 0; k < part.n_u * part.n_v; ++k) {
            const int i = part.i + k % part.n_u, j = part.j + k / part.n_u;
            const int m = j * grid.n_u + i, v0 = j * grid.up + i;
            if (grid.classes[m] == 0) continue;
            const int vertex[4] = {v0, v0 + grid.right, v0 + grid.right + grid.up, v0 + grid.up};
            const MicropolygonSweep sweep(grid, vertex, segment);
            const Rect range = sweep.pixels(pixels);
            if (range.empty()) continue;
            const bool full =
                m_entries.size() + kBlocksOfTile > m_limits.entries ||
                (m_entries.size() + kBlocksOfTile) * sizeof(ComputeEntry) > m_limits.buffer_bytes ||
                (first_vertex == kNotYet &&
                 (m_vertices.size() + vertices) * sizeof(Vec4f) > m_limits.buffer_bytes);
            if (full && !m_entries.empty()) {
                run();
                first_vertex = kNotYet;
            }
            if (first_vertex == kNotYet) first_vertex = add_vertices(grid, segment);
            const ComputeEntry entry{
                first_vertex + static_cast<std::uint32_t>(v0),
                static_cast<std::uint32_t>(grid.right),
                static_cast<std::uint32_t>(grid.up),
                grid.segments ? static_cast<std::uint32_t>(grid.vertices) : 0,
                grid.base + static_cast<SurfaceId>(m),
                static_cast<std::uint32_t>(range.x0 | (range.x1 - 1) << 4 | range.y0 << 8 |
                                           (range.y1 - 1) << 12),
                static_cast<std::uint32_t>(segment),
                static_cast<std::uint32_t>(grid.segments),
                grid.classes[m],
                0.0f,
                0.0f};
            add_to_blocks(entry, tile, range, sweep, life);
        }
    }
}

std::uint32_t ComputeBatch::add_vertices(const SimdGrid& grid, int segment) {
    const auto first = static_cast<std::uint32_t>(m_vertices.size());
    const std::size_t begin = static_cast<std::size_t>(segment) * grid.vertices;
    const std::size_t end =
        begin + static_cast<std::size_t>(grid.vertices) * (grid.segments ? 2 : 1);
    for (std::size_t i = begin; i < end; ++i)
        m_vertices.emplace_back(grid.x[i], grid.y[i], grid.w[i], grid.z[i]);
    m_moving = m_moving || grid.segments > 0;
    return first;
}

void ComputeBatch::add_to_blocks(ComputeEntry entry, std::uint32_t tile, const Rect& pixels,
                                 const MicropolygonSweep& sweep, const Interval& life) {
    for (int y = pixels.y0 / kBlockSide; y <= (pixels.y1 - 1) / kBlockSide; ++y)
        for (int x = pixels.x0 / kBlockSide; x <= (pixels.x1 - 1) / kBlockSide; ++x) {
            const Interval seen = sweep.over(
                {x * kBlockSide, y * kBlockSide, (x + 1) * kBlockSide, (y + 1) * kBlockSide});
            entry.from = std::max(seen.from, life.from);
            entry.to = std::min(seen.to, life.to);
            if (!(entry.from <= entry.to)) continue;
            const auto block = static_cast<std::uint32_t>(y * kBlocks + x);
            const std::uint32_t list =
                (tile * kBlocksOfTile + block) * 2 + (entry.kind & kTransparent ? 1 : 0);
            m_entries.push_back(entry);
            m_list.push_back(list);
            m_list_count = std::max(m_list_count, list + 1);
        }
}

void ComputeBatch::clear() {
    m_entries.clear();
    m_list.clear();
    m_vertices.clear();
    m_list_count = 0;
    m_moving = false;
}

// Counting sort, stable.
ComputeBatch::Lists ComputeBatch::lists() const {
    std::vector<std::uint32_t> first(m_list_count + 1, 0);
    for (const std::uint32_t list : m_list) ++first[list + 1];
    Lists out;
    for (std::uint32_t list = 0; list < m_list_count; ++list) {
        const std::uint32_t count = first[list + 1], tile_block = list / 2;
        first[list + 1] += first[list];
        if (count == 0) continue;
        auto& blocks = list % 2 ? out.transparent : out.opaque;
        blocks.push_back({static_cast<std::uint32_t>(tile_block / kBlocksOfTile),
                          static_cast<std::uint32_t>(tile_block % kBlocksOfTile), first[list],
                          count});
    }
    out.entries.resize(m_entries.size());
    for (std::size_t i = 0; i < m_entries.size(); ++i)
        out.entries[first[m_list[i]]++] = m_entries[i];
    return out;
}

}  // namespace granita
