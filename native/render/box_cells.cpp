// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/box_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace granita {
namespace {

/// Boxes a cell, about, and most cells to a side.
constexpr double kBoxes = 4.0;
constexpr int kMostSide = 128;

}  // namespace

BoxCells::BoxCells(std::span<const Bounds3f> boxes) {
    Bounds3f all;
    for (const Bounds3f& box : boxes) all.add(box);
    const Vec3f size = all.hi - all.lo;
    std::array axes = {0, 1, 2};
    std::ranges::sort(axes, [&](int a, int b) { return size[a] > size[b]; });
    m_side = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(boxes.size()) / kBoxes)), 1,
                        kMostSide);
    for (int c = 0; c < 2; ++c) {
        m_axes[c] = axes[static_cast<std::size_t>(c)];
        m_origin[c] = all.lo[m_axes[c]];
        const float length = size[m_axes[c]];
        m_cells[c] = length > 0.0f ? static_cast<float>(m_side) / length : 0.0f;
    }
    const auto each = [&](const auto& visit) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Cells in = cells_of(boxes[i]);
            for (int y = in.y0; y <= in.y1; ++y)
                for (int x = in.x0; x <= in.x1; ++x)
                    visit(cell(x, y), Entry{static_cast<std::uint32_t>(i), in.x0, in.y0});
        }
    };
    m_begin.assign(static_cast<std::size_t>(m_side * m_side) + 1, 0);
    each([&](std::size_t cell, const Entry&) { ++m_begin[cell + 1]; });
    for (std::size_t i = 1; i < m_begin.size(); ++i) m_begin[i] += m_begin[i - 1];
    m_entries.resize(m_begin.back());
    std::vector<std::uint32_t> next(m_begin.begin(), m_begin.end() - 1);
    each([&](std::size_t cell, const Entry& entry) { m_entries[next[cell]++] = entry; });
}

BoxCells::Cells BoxCells::cells_of(const Bounds3f& box) const {
    const auto at = [this](float place, int c) {
        const float cell = (place - m_origin[c]) * m_cells[c];
        return static_cast<int>(std::clamp(cell, 0.0f, static_cast<float>(m_side - 1)));
    };
    return {at(box.lo[m_axes[0]], 0), at(box.lo[m_axes[1]], 1), at(box.hi[m_axes[0]], 0),
            at(box.hi[m_axes[1]], 1)};
}

}  // namespace granita
