// SPDX-License-Identifier: GPL-3.0-or-later
// From a grid's shading points to its vertices, where these are not the same
// (Grid::shading_positions): what reads a shaded grid knows vertices alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "dice/grid.h"

namespace granita {

/// `values` [points][width] becomes [vertices][width]: linear between the points of a lattice,
/// each vertex's point of separate micropolygons.  What is equal at points is equal at vertices.
template <class T>
void interpolate_points(const Grid& grid, std::size_t width, std::vector<T>& values) {
    if (grid.shading_positions.anchors.empty() || values.empty()) return;
    std::vector<T> spread;
    spread.reserve(static_cast<std::size_t>(grid.vertex_count()) * width);
    if (grid.disjoint) {
        for (const std::uint32_t point : grid.shading_positions.point_of) {
            const T* from = &values[point * width];
            spread.insert(spread.end(), from, from + width);
        }
        values = std::move(spread);
        return;
    }
    const auto mix = [](const T& a, const T& b, float t) { return a + (b - a) * t; };
    const int step_u = grid.shading_positions.step_u, step_v = grid.shading_positions.step_v;
    const int row = grid.n_u / step_u + 1, last_row = grid.n_v / step_v;
    for (int j = 0; j <= grid.n_v; ++j)
        for (int i = 0; i <= grid.n_u; ++i) {
            const int a = i / step_u, c = j / step_v;
            const int b = std::min(a + 1, row - 1), d = std::min(c + 1, last_row);
            const float s = static_cast<float>(i % step_u) / static_cast<float>(step_u);
            const float t = static_cast<float>(j % step_v) / static_cast<float>(step_v);
            const auto at = [&](int x, int y) {
                return &values[static_cast<std::size_t>(y * row + x) * width];
            };
            for (std::size_t k = 0; k < width; ++k)
                spread.push_back(
                    mix(mix(at(a, c)[k], at(b, c)[k], s), mix(at(a, d)[k], at(b, d)[k], s), t));
        }
    values = std::move(spread);
}

}  // namespace granita
