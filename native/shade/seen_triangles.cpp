// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/seen_triangles.h"

#include <algorithm>

namespace granita {
namespace {

/// Of a vertex, in the order of Grid::Corners.
int corner_of(const Grid& grid, std::uint32_t vertex) {
    constexpr int kCornerOfRun[4] = {0, 1, 3, 2};
    return kCornerOfRun[vertex / static_cast<std::uint32_t>(grid.n_u)];
}

GridTriangle triangle_of(const Grid& grid, const RefinedPoint& point) {
    const bool second = std::ranges::any_of(
        point.vertex, [&](std::uint32_t vertex) { return corner_of(grid, vertex) == 3; });
    return {point.vertex[0] % static_cast<std::uint32_t>(grid.n_u), second};
}

}  // namespace

SeenTriangles::SeenTriangles(const Grid& faces, std::span<const RefinedPoint> wanted)
    : points(wanted.begin(), wanted.end()) {
    std::vector<GridTriangle> seen;
    seen.reserve(wanted.size());
    for (const RefinedPoint& point : wanted) seen.push_back(triangle_of(faces, point));
    std::ranges::sort(seen);
    seen.erase(std::ranges::unique(seen).begin(), seen.end());
    grid = faces.triangles(faces, seen);
    for (RefinedPoint& point : points) {
        const GridTriangle triangle = triangle_of(faces, point);
        const auto index = std::ranges::lower_bound(seen, triangle) - seen.begin();
        const Grid::Corners c = grid.corners(static_cast<int>(index));
        const int first[4] = {c.v0, c.v1, c.v2, 0}, second[4] = {c.v0, 0, c.v1, c.v2};
        for (std::uint32_t& vertex : point.vertex)
            vertex = static_cast<std::uint32_t>(
                (triangle.second ? second : first)[corner_of(faces, vertex)]);
    }
}

}  // namespace granita
