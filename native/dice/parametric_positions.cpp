// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/parametric_positions.h"

#include <algorithm>

namespace granita {

int ParametricPositions::vertex(int side, int i) const {
    const int row = n_u + 1;
    switch (side) {
        case 0:
            return i;
        case 1:
            return i * row + n_u;
        case 2:
            return n_v * row + i;
        default:
            return i * row;
    }
}

void ParametricPositions::find(const Vec2d* corners, int along_u, int along_v,
                               const std::vector<int>* ends) {
    n_u = along_u;
    n_v = along_v;
    std::copy_n(corners, 4, corner_uv);
    uv.clear();
    from.clear();
    for (int j = 0; j <= n_v; ++j)
        for (int i = 0; i <= n_u; ++i) {
            from.push_back(static_cast<std::uint32_t>(uv.size()));
            uv.push_back(regular(i, j));
        }
    for (int side = 0; side < 4; ++side) {
        if (ends[side].empty()) continue;
        snap(side, ends[side]);
        for (int i = 0; i <= side_steps(side); ++i) {
            const int to = vertex(side, snapped[side][static_cast<std::size_t>(i)]);
            const auto at = static_cast<std::size_t>(vertex(side, i));
            from[at] = static_cast<std::uint32_t>(to);
            uv[at] = regular(to % (n_u + 1), to / (n_u + 1));
        }
    }
    find_steps(ends[0].empty() || ends[2].empty(), ends[1].empty() || ends[3].empty());
}

/// For each step of a side the vertex of the edge that it lies on: the nearest, so that order is
/// kept and each is met.
void ParametricPositions::snap(int side, const std::vector<int>& ends) {
    snapped[side].clear();
    std::size_t leaf = 1;
    for (int i = 0; i <= side_steps(side); ++i) {
        while (leaf + 1 < ends.size() && i >= ends[leaf]) ++leaf;
        snapped[side].push_back(2 * i < ends[leaf - 1] + ends[leaf] ? ends[leaf - 1] : ends[leaf]);
    }
}

void ParametricPositions::find_steps(bool middle_u, bool middle_v) {
    step_u.clear();
    step_v.clear();
    for (int j = 0; j <= n_v; ++j)
        for (int i = 0; i <= n_u; ++i) {
            step_u.push_back(row_step(middle_u ? 0.5 * n_v : j));
            step_v.push_back(column_step(middle_v ? 0.5 * n_u : i));
        }
}

}  // namespace granita
