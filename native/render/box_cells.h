// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/bounds.h"

namespace granita {

/// Finite boxes by the cells that they lie in, of a raster along the two longest axes of all
/// together: who is beside a box is found among few.
class BoxCells {
  public:
    BoxCells() = default;
    explicit BoxCells(std::span<const Bounds3f> boxes);

    /// `visit(index)` once of each that may overlap `box`, and of some that do not.
    template <class Visit>
    void each_near(const Bounds3f& box, const Visit& visit) const {
        if (m_entries.empty()) return;
        const Cells near = cells_of(box);
        for (int y = near.y0; y <= near.y1; ++y)
            for (int x = near.x0; x <= near.x1; ++x)
                for (std::uint32_t i = m_begin[cell(x, y)]; i < m_begin[cell(x, y) + 1]; ++i) {
                    const Entry& entry = m_entries[i];
                    // In the first of the cells in which they are together.
                    if (x == std::max(entry.x0, near.x0) && y == std::max(entry.y0, near.y0))
                        visit(entry.index);
                }
    }

    /// How many are in how many cells, in all.
    std::size_t entries() const { return m_entries.size(); }

  private:
    struct Cells {
        int x0, y0, x1, y1;  ///< including the last
    };
    struct Entry {
        std::uint32_t index;
        int x0, y0;  ///< its first cell
    };
    Cells cells_of(const Bounds3f& box) const;
    std::size_t cell(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(m_sides[0]) +
               static_cast<std::size_t>(x);
    }

    int m_axes[2] = {0, 1}, m_sides[2] = {1, 1};
    float m_origin[2] = {0, 0}, m_cells[2] = {0, 0};  ///< and cells a metre
    std::vector<std::uint32_t> m_begin;               ///< [cells + 1] of their entries
    std::vector<Entry> m_entries;
};

}  // namespace granita
