// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/left_to_samples.h"

#include <algorithm>
#include <cmath>

#include "dice/visible_area.h"
#include "shade/refined_points.h"

namespace granita {
namespace {

/// Ways of samples for each of a grid's points.  In thickets edges outweigh the noise of light, and
/// corners out of sight the seconds; where less is hidden, points share what their ways find, which
/// samples do not (docs/decisions/bounces.md has what was measured).
constexpr double kOfThickets = 2.0;
constexpr double kOfOthers = 0.5;
/// Of what is rough nearly all samples are shaded by themselves anyway, whatever its points find.
constexpr double kOfRough = 10.0;
/// Part of the points that is seen above which nothing much hides a grid.
constexpr double kNearlyAll = 0.9;
/// Of unit normals, how far those of a micropolygon's two diagonals differ, in the mean, over the
/// shading threshold (.06).  Of what a noise displaces (.2 to .4) corners settle a tenth of the
/// micropolygons, of smooth waves (.02) all.
constexpr double kRough = 2.5;

/// As thresholds of displayed color fall with samples.
double least_rough(const Options& options) {
    return kRough * options.shading_threshold * std::min(1.0, std::sqrt(64.0 / options.samples));
}

double roughness(const Grid& grid) {
    if (grid.shades_faces() || grid.shades_lattice()) return 0.0;
    double sum = 0.0;
    const auto normal = [&](int vertex) {
        return grid.normal[grid.point_at(static_cast<std::size_t>(vertex))];
    };
    for (int m = 0; m < grid.micropolygon_count(); ++m) {
        const Grid::Corners c = grid.corners(m);
        sum += glm::length(normal(c.v0) + normal(c.v2) - normal(c.v1) - normal(c.v3));
    }
    return sum / grid.micropolygon_count();
}

/// Ways that all samples of a lattice would send for each that its points would.
double ways_of_samples(const Grid& grid, const ShadingPoints& points, double seen,
                       const Scene& scene, const DirectLight& light) {
    const std::span<const Vec3f> corners(grid.positions.data(),
                                         static_cast<std::size_t>(grid.vertex_count()));
    const double area = visible_area(grid, corners, scene.camera.projection);
    const float sampled = 1.0f / static_cast<float>(scene.options.samples);  // of a pixel, by one
    const int each = light.sample_count(grid.point_share * refined_light_fraction(sampled));
    double ways = 0.0;
    for (std::size_t i = 0; i < points.count; ++i)
        ways +=
            light.sample_count(points.share * (points.shares.empty() ? 1.0f : points.shares[i]));
    return seen * area * scene.options.samples * each / ways;
}

}  // namespace

bool pays_by_samples(const Grid& grid, const ShadingPoints& points, bool looked, const Scene& scene,
                     const DirectLight& light) {
    if (looked && points.seen.empty()) return false;
    if (!looked)
        return roughness(grid) > least_rough(scene.options) &&
               ways_of_samples(grid, points, 1.0, scene, light) < kOfRough;
    const double seen = static_cast<double>(std::ranges::count(points.seen, 1)) /
                        static_cast<double>(points.seen.size());
    // Points of small faces are as many as these.
    if (grid.disjoint) return seen < 0.5;
    if (!points.thicket && seen > kNearlyAll) return false;
    return ways_of_samples(grid, points, seen, scene, light) <
           (points.thicket ? kOfThickets : kOfOthers);
}

}  // namespace granita
