// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/hierarchical_grid.h"

#include <algorithm>

namespace granita {
namespace {

/// Cells that a thing may be listed in.  What touches no more buckets than that has exact lists;
/// anything larger, lists at most (5/4)^2 / (3/4)^2 = 2.8 times as long as its buckets.
constexpr int kMostCells = 16;
/// Cells of the finest level, so that a thing that is alone in a large area is not mostly cells.
constexpr std::size_t kCellsAThing = 4, kFewCells = 32;

int cells_along(int buckets, int shift) {
    return ((buckets - 1) >> shift) + 1;
}

/// The cells of a range of buckets, both counted from the area's corner.
Rect cells_of(const Rect& range, int shift) {
    return {range.x0 >> shift, range.y0 >> shift, ((range.x1 - 1) >> shift) + 1,
            ((range.y1 - 1) >> shift) + 1};
}

}  // namespace

template <class Visit>
void HierarchicalGrid::for_each_cell(const Rect& range, Visit visit) const {
    if (range.empty()) return;
    const Rect own{range.x0 - m_area.x0, range.y0 - m_area.y0, range.x1 - m_area.x0,
                   range.y1 - m_area.y0};
    for (const Level& level : m_levels) {
        const Rect cells = cells_of(own, level.shift);
        if (cells.width() * cells.height() > kMostCells) continue;
        for (int y = cells.y0; y < cells.y1; ++y)
            for (int x = cells.x0; x < cells.x1; ++x)
                visit(level.first + static_cast<std::uint32_t>(y * level.width + x));
        return;
    }
}

HierarchicalGrid::HierarchicalGrid(const Rect& area, std::span<const Rect> ranges) : m_area(area) {
    if (area.empty()) return;
    std::size_t cells = 0;
    for (int shift = 0;; ++shift) {
        const int width = cells_along(area.width(), shift);
        const int height = cells_along(area.height(), shift);
        const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        const bool fits = count <= kCellsAThing * ranges.size() + kFewCells;
        if (fits) {
            m_levels.push_back({shift, width, static_cast<std::uint32_t>(cells)});
            cells += count;
        }
        if (count == 1) break;
    }
    // A counting sort of things by cell.
    m_first.assign(cells + 1, 0);
    for (const Rect& range : ranges)
        for_each_cell(range, [&](std::uint32_t cell) { ++m_first[cell + 1]; });
    for (std::size_t cell = 0; cell < cells; ++cell) m_first[cell + 1] += m_first[cell];
    m_things.resize(m_first.back());
    std::vector<std::uint32_t> next(m_first.begin(), m_first.end() - 1);
    for (std::uint32_t thing = 0; thing < ranges.size(); ++thing)
        for_each_cell(ranges[thing], [&](std::uint32_t cell) { m_things[next[cell]++] = thing; });
}

}  // namespace granita
