// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many things touch a bucket, in memory that follows the things, not things times buckets:
// a hierarchical grid (Ericson, Real-Time Collision Detection, 2005, 7.2).  Its levels have cells
// of 1, 2x2, 4x4 ... buckets, and a thing is listed at the finest level where it touches few of
// them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/bounds.h"

namespace granita {

class HierarchicalGrid {
  public:
    HierarchicalGrid() = default;
    /// `area`: buckets; `ranges` [things]: the buckets that each touches, within the area; empty:
    /// none.
    HierarchicalGrid(const Rect& area, std::span<const Rect> ranges);

    /// visit(thing) for all that touch the bucket (x, y) of the area, each once, and some that
    /// touch others only: the caller looks at their ranges.
    template <class Visit>
    void for_each(int x, int y, Visit visit) const {
        for (const Level& level : m_levels) {
            const std::uint32_t cell = level.cell(x - m_area.x0, y - m_area.y0);
            for (std::uint32_t i = m_first[cell]; i < m_first[cell + 1]; ++i) visit(m_things[i]);
        }
    }

    /// Numbers that it keeps: at most 24 a thing and 90 besides, however many buckets there are.
    std::size_t entries() const { return m_things.size() + m_first.size(); }

  private:
    struct Level {
        int shift;            ///< log2 of the buckets along a cell's side
        int width;            ///< cells
        std::uint32_t first;  ///< cell
        std::uint32_t cell(int x, int y) const {
            return first + static_cast<std::uint32_t>((y >> shift) * width + (x >> shift));
        }
    };
    template <class Visit>
    void for_each_cell(const Rect& range, Visit visit) const;

    Rect m_area;
    std::vector<Level> m_levels;          ///< finest first, the last of one cell
    std::vector<std::uint32_t> m_first;   ///< [cells + 1] into `m_things`
    std::vector<std::uint32_t> m_things;  ///< by cell, ascending in each
};

}  // namespace granita
