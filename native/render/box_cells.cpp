// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/box_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace granita {
namespace {

/// Boxes a cell, about, and most cells to a side.
constexpr float kBoxes = 4.0f, kMostSide = 128.0f;

}  // namespace

BoxCells::BoxCells(std::span<const Bounds3f> boxes) {
    Bounds3f all;
    Vec3f lengths(0.0f);
    for (const Bounds3f& box : boxes) {
        all.add(box);
        lengths += box.hi - box.lo;
    }
    const Vec3f size = all.hi - all.lo;
    std::array axes = {0, 1, 2};
    std::ranges::sort(axes, [&](int a, int b) { return size[a] > size[b]; });
    const auto count = static_cast<float>(boxes.size());
    for (int c = 0; c < 2; ++c) {
        const int axis = m_axes[c] = axes[static_cast<std::size_t>(c)];
        m_origin[c] = all.lo[axis];
        // Not smaller than boxes are in the mean, or these would lie in many.
        const float fitting = lengths[axis] > 0.0f ? size[axis] / lengths[axis] * count : 1.0f;
        const float side = std::min(std::sqrt(count / kBoxes), fitting);
        m_sides[c] = side > 1.0f ? static_cast<int>(std::min(side, kMostSide)) : 1;
        if (m_sides[c] > 1) m_cells[c] = static_cast<float>(m_sides[c]) / size[axis];
    }
    const auto each = [&](const auto& visit) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Cells in = cells_of(boxes[i]);
            for (int y = in.y0; y <= in.y1; ++y)
                for (int x = in.x0; x <= in.x1; ++x)
                    visit(cell(x, y), Entry{static_cast<std::uint32_t>(i), in.x0, in.y0});
        }
    };
    m_begin.assign(cell(0, m_sides[1]) + 1, 0);
    each([&](std::size_t cell, const Entry&) { ++m_begin[cell + 1]; });
    for (std::size_t i = 1; i < m_begin.size(); ++i) m_begin[i] += m_begin[i - 1];
    m_entries.resize(m_begin.back());
    std::vector<std::uint32_t> next(m_begin.begin(), m_begin.end() - 1);
    each([&](std::size_t cell, const Entry& entry) { m_entries[next[cell]++] = entry; });
}

BoxCells::Cells BoxCells::cells_of(const Bounds3f& box) const {
    const auto at = [this](float place, int c) {
        const float cell = (place - m_origin[c]) * m_cells[c];
        if (!(cell > 0.0f)) return 0;  // or no number
        return static_cast<int>(std::min(cell, static_cast<float>(m_sides[c] - 1)));
    };
    return {at(box.lo[m_axes[0]], 0), at(box.lo[m_axes[1]], 1), at(box.hi[m_axes[0]], 0),
            at(box.hi[m_axes[1]], 1)};
}

}  // namespace granita
