// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "math/vec.h"

namespace granita {

/// Where the vertices of a lattice lie in its patch: regular inside; along each side on the nearest
/// of the vertices that the side's edge has.
class ParametricPositions {
  public:
    /// `corner_uv` [4]; `ends` [4]: where the leaves of each side end, in steps of the lattice,
    /// from 0 on (bottom, right, top, left); empty: the side is a point.
    void find(const Vec2d* corner_uv, int n_u, int n_v, const std::vector<int>* ends);

    std::vector<Vec2d> uv;  ///< [vertices]
    /// [vertices] change of (u, v) over one step.  At a corner where a side is a point, the step in
    /// the middle of the lattice stands in: a texture look-up there needs a footprint too.
    std::vector<Vec2d> step_u, step_v;
    std::vector<int> snapped[4];  ///< [steps + 1] of a side: the step whose place each has

    int side_steps(int side) const { return side % 2 == 0 ? m_n_u : m_n_v; }
    /// Lattice vertex at step i of a side.
    int vertex(int side, int i) const;

  private:
    void snap(int side, const std::vector<int>& ends);
    void find_steps(const Vec2d* corner_uv, bool middle_u, bool middle_v);

    int m_n_u = 1, m_n_v = 1;
};

}  // namespace granita
