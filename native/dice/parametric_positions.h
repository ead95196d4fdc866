// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace granita {

/// Where the vertices of a lattice lie in its patch: regular inside; along each side on the nearest
/// of the vertices that the side's edge has.
class ParametricPositions {
  public:
    /// `corners` [4]; `ends` [4]: where the leaves of each side end, in steps of the lattice, from
    /// 0 on (bottom, right, top, left); empty: the side is a point.
    void find(const Vec2d* corners, int n_u, int n_v, const std::vector<int>* ends);

    int n_u = 1, n_v = 1;
    Vec2d corner_uv[4] = {};
    std::vector<Vec2d> uv;  ///< [vertices]
    /// [vertices] change of (u, v) over one step.  At a corner where a side is a point, the step in
    /// the middle of the lattice stands in: a texture look-up there needs a footprint too.
    std::vector<Vec2d> step_u, step_v;
    /// [vertices] the one in whose regular place each stands: itself, but for the border.
    std::vector<std::uint32_t> from;
    std::vector<int> snapped[4];  ///< [steps + 1] of a side: the step whose place each has

    std::size_t vertex_count() const { return uv.size(); }
    int side_steps(int side) const { return side % 2 == 0 ? n_u : n_v; }
    /// Lattice vertex at step i of a side.
    int vertex(int side, int i) const;
    /// Steps from the first vertex, inside the lattice or beside it.
    Vec2d regular(int i, int j) const {
        const double s = static_cast<double>(i) / n_u, t = static_cast<double>(j) / n_v;
        return (corner_uv[0] * (1.0 - s) + corner_uv[1] * s) * (1.0 - t) +
               (corner_uv[3] * (1.0 - s) + corner_uv[2] * s) * t;
    }
    /// Change of (u, v) over a step along u in a row, and along v in a column.
    Vec2d row_step(double row) const {
        const double t = row / n_v;
        return ((corner_uv[1] - corner_uv[0]) * (1.0 - t) + (corner_uv[2] - corner_uv[3]) * t) /
               static_cast<double>(n_u);
    }
    Vec2d column_step(double column) const {
        const double s = column / n_u;
        return ((corner_uv[3] - corner_uv[0]) * (1.0 - s) + (corner_uv[2] - corner_uv[1]) * s) /
               static_cast<double>(n_v);
    }

  private:
    void snap(int side, const std::vector<int>& ends);
    void find_steps(bool middle_u, bool middle_v);
};

}  // namespace granita
