// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/parametric_positions.h"

namespace granita {
namespace {

/// Corners of a side in the patch's direction: bottom, right, top, left.
constexpr int kStart[4] = {0, 1, 3, 0}, kEnd[4] = {1, 2, 2, 3};

Vec2d bilinear(const Vec2d* c, double s, double t) {
    return (c[0] * (1.0 - s) + c[1] * s) * (1.0 - t) + (c[3] * (1.0 - s) + c[2] * s) * t;
}

}  // namespace

int ParametricPositions::vertex(int side, int i) const {
    const int row = m_n_u + 1;
    switch (side) {
        case 0:
            return i;
        case 1:
            return i * row + m_n_u;
        case 2:
            return m_n_v * row + i;
        default:
            return i * row;
    }
}

void ParametricPositions::find(const Vec2d* corner_uv, int n_u, int n_v,
                               const std::vector<int>* ends) {
    m_n_u = n_u;
    m_n_v = n_v;
    uv.clear();
    for (int j = 0; j <= n_v; ++j)
        for (int i = 0; i <= n_u; ++i)
            uv.push_back(
                bilinear(corner_uv, static_cast<double>(i) / n_u, static_cast<double>(j) / n_v));
    for (int side = 0; side < 4; ++side) {
        if (ends[side].empty()) continue;
        snap(side, ends[side]);
        const int steps = side_steps(side);
        for (int i = 0; i <= steps; ++i) {
            const double s =
                static_cast<double>(snapped[side][static_cast<std::size_t>(i)]) / steps;
            uv[static_cast<std::size_t>(vertex(side, i))] =
                corner_uv[kStart[side]] * (1.0 - s) + corner_uv[kEnd[side]] * s;
        }
    }
    find_steps(corner_uv, ends[0].empty() || ends[2].empty(), ends[1].empty() || ends[3].empty());
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

void ParametricPositions::find_steps(const Vec2d* c, bool middle_u, bool middle_v) {
    const double n_u = m_n_u, n_v = m_n_v;
    step_u.clear();
    step_v.clear();
    for (int j = 0; j <= m_n_v; ++j)
        for (int i = 0; i <= m_n_u; ++i) {
            const double s = middle_v ? 0.5 : i / n_u, t = middle_u ? 0.5 : j / n_v;
            step_u.push_back(((c[1] - c[0]) * (1.0 - t) + (c[2] - c[3]) * t) / n_u);
            step_v.push_back(((c[3] - c[0]) * (1.0 - s) + (c[2] - c[1]) * s) / n_v);
        }
}

}  // namespace granita
