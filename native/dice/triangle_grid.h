// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <iterator>
#include <vector>

#include "dice/grid.h"
#include "dice/motion_bounds.h"

namespace granita {

/// Of the corner in each of a grid's four runs of vertices: the last one repeats.
inline constexpr std::size_t kCornerOfRun[4] = {0, 1, 2, 2};

/// [4 n][width] from [3 n][width]: values of the corners of triangles as vertices of their grid.
template <class Value>
void spread_corners(std::size_t width, const std::vector<Value>& of_corners,
                    std::vector<Value>& out) {
    const std::size_t count = of_corners.size() / (3 * width);
    out.reserve(4 * count * width);
    for (const std::size_t corner : kCornerOfRun)
        for (std::size_t t = 0; t < count; ++t)
            for (std::size_t c = 0; c < width; ++c)
                out.push_back(of_corners[(3 * t + corner) * width + c]);
}

/// [4 n] from [n]: what is the same at all corners of a triangle.
template <class Value>
void repeat_runs(const std::vector<Value>& of_triangles, std::vector<Value>& out) {
    out.reserve(std::size(kCornerOfRun) * of_triangles.size());
    for (std::size_t run = 0; run < std::size(kCornerOfRun); ++run)
        out.insert(out.end(), of_triangles.begin(), of_triangles.end());
}

/// A grid of `count` triangles of another one, `triangle_at(i)`, in place at every knot.
template <class TriangleAt>
Grid triangle_grid(const Grid& from, const Knots& knots, std::size_t count,
                   const TriangleAt& triangle_at) {
    Grid grid;
    grid.key = from.key;
    grid.instance = from.instance;
    grid.material = from.material;
    grid.holdout = from.holdout;
    grid.lifespan = from.lifespan;
    grid.disjoint = true;
    grid.n_u = static_cast<int>(count);
    grid.n_v = 1;
    grid.knots = from.knots;
    grid.motion = from.motion;
    const auto stride = static_cast<std::size_t>(from.vertex_count());
    grid.positions.reserve(4 * count * static_cast<std::size_t>(grid.knots));
    for (std::size_t k = 0; k < static_cast<std::size_t>(grid.knots); ++k)
        for (const std::size_t corner : kCornerOfRun)
            for (std::size_t t = 0; t < count; ++t) {
                const GridTriangle& triangle = triangle_at(t);
                const Grid::Corners c = from.corners(static_cast<int>(triangle.micropolygon));
                grid.positions.push_back(
                    from.positions[k * stride + static_cast<std::size_t>(c.of(triangle, corner))]);
            }
    set_frame_positions(grid, knots);
    return grid;
}

}  // namespace granita
