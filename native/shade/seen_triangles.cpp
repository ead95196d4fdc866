// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/seen_triangles.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace granita {
namespace {

GridPlace place_of(const Grid& grid, const RefinedPoint& point) {
    // Of a first triangle the second vertex is corner 1, of a second one corner 2.
    const auto row = static_cast<std::uint32_t>(grid.up());
    const std::uint32_t first = point.vertex[0];
    const std::uint32_t micropolygon =
        grid.disjoint ? first : first / row * static_cast<std::uint32_t>(grid.n_u) + first % row;
    const Grid::Corners c = grid.corners(static_cast<int>(micropolygon));
    return {{micropolygon, point.vertex[1] == static_cast<std::uint32_t>(c.v2)},
            {point.weight[0], point.weight[1], point.weight[2]}};
}

}  // namespace

SeenTriangles::SeenTriangles(const Grid& from, std::span<const RefinedPoint> wanted)
    : points(wanted.begin(), wanted.end()) {
    std::vector<GridPlace> places;
    places.reserve(wanted.size());
    for (const RefinedPoint& point : wanted) places.push_back(place_of(from, point));
    std::vector<std::size_t> index(places.size());
    if (from.disjoint) {
        // Many samples see the same face, whose corners say all of it.
        std::vector<GridPlace> seen = places;
        std::ranges::sort(seen, {}, &GridPlace::triangle);
        const auto rest = std::unique(
            seen.begin(), seen.end(),
            [](const GridPlace& a, const GridPlace& b) { return a.triangle == b.triangle; });
        seen.erase(rest, seen.end());
        for (std::size_t i = 0; i < places.size(); ++i)
            index[i] = static_cast<std::size_t>(
                std::ranges::lower_bound(seen, places[i].triangle, {}, &GridPlace::triangle) -
                seen.begin());
        places = std::move(seen);
    } else {
        std::iota(index.begin(), index.end(), std::size_t{0});
    }
    if (!from.opacity.empty())
        for (const RefinedPoint& at : wanted)
            opacity.push_back(from.opacity[at.vertex[0]] * at.weight[0] +
                              from.opacity[at.vertex[1]] * at.weight[1] +
                              from.opacity[at.vertex[2]] * at.weight[2]);
    grid = from.triangles(from, places);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Grid::Corners c = grid.corners(static_cast<int>(index[i]));
        for (std::size_t k = 0; k < 3; ++k)
            points[i].vertex[k] = static_cast<std::uint32_t>(c.of({}, k));
    }
}

}  // namespace granita
