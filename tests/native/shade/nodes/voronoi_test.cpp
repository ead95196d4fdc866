// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/voronoi.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace granita {
namespace {

/// Of the points of all cells around a place, the ways to them, from the nearest on.
template <std::size_t N>
std::vector<double> ways_to_all(const CellPoint<N>& place, float randomness, Metric metric,
                                double exponent) {
    std::vector<double> ways;
    int cells = 1;
    for (std::size_t c = 0; c < N; ++c) cells *= 3;
    for (int i = 0; i < cells; ++i) {
        CellPoint<N> cell;
        for (std::size_t c = 0, rest = static_cast<std::size_t>(i); c < N; ++c, rest /= 3)
            cell[c] = std::floor(place[c]) + static_cast<float>(rest % 3) - 1.0f;
        const CellPoint<N> point = point_in_cell<N>(cell, false);
        double sum = 0.0;
        for (std::size_t c = 0; c < N; ++c) {
            const double way = std::abs(double(cell[c]) + randomness * point[c] - place[c]);
            if (metric == Metric::Euclidean) sum += way * way;
            if (metric == Metric::Manhattan) sum += way;
            if (metric == Metric::Chebychev) sum = std::max(sum, way);
            if (metric == Metric::Minkowski) sum += std::pow(way, exponent);
        }
        if (metric == Metric::Euclidean) sum = std::sqrt(sum);
        if (metric == Metric::Minkowski) sum = std::pow(sum, 1.0 / exponent);
        ways.push_back(sum);
    }
    std::ranges::sort(ways);
    return ways;
}

/// Cells that are left out because none of their points can be near are none of these.
template <std::size_t N>
void expect_nearest(Metric metric, float exponent, float randomness) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> anywhere(-9.0f, 9.0f);
    const VoronoiInputs in{randomness, exponent, 0.0f, 0.0f, 0.5f, 2.0f};
    for (int i = 0; i < 300; ++i) {
        CellPoint<N> place;
        for (float& x : place) x = anywhere(random);
        const auto ways = ways_to_all<N>(place, randomness, metric, exponent);
        const float first =
            Voronoi<N>({metric, VoronoiFeature::F1}, in, false).value(place).distance;
        const float second =
            Voronoi<N>({metric, VoronoiFeature::F2}, in, false).value(place).distance;
        // Places are rounded to 1e-6 beside their cell, powers below 1 are steep there, and those
        // of 32 are 0 in floats below .04.
        const double rounding = exponent < 1.0f ? 2e-3 : exponent > 8.0f ? 0.04 : 2e-5;
        ASSERT_NEAR(first, ways[0], rounding) << i;
        ASSERT_NEAR(second, ways[1], rounding) << i;
    }
}

TEST(Voronoi, FindsTheNearestPointsOfAllCellsAround) {
    for (const float randomness : {0.0f, 0.4f, 1.0f}) {
        for (const Metric metric : {Metric::Euclidean, Metric::Manhattan, Metric::Chebychev}) {
            expect_nearest<2>(metric, 1.0f, randomness);
            expect_nearest<3>(metric, 1.0f, randomness);
            expect_nearest<4>(metric, 1.0f, randomness);
        }
        for (const float exponent : {0.5f, 1.5f, 2.0f, 6.0f, 32.0f})
            expect_nearest<3>(Metric::Minkowski, exponent, randomness);
    }
}

/// As far as all points are that the power of 0, or of less, makes infinitely far.
TEST(Voronoi, HasNoNearestPointWithoutAPower) {
    for (const float exponent : {0.0f, std::nanf("")}) {
        const VoronoiInputs in{1.0f, exponent, 0.0f, 0.0f, 0.5f, 2.0f};
        const Voronoi<3> voronoi({Metric::Minkowski}, in, true);
        const VoronoiValue<3> value = voronoi.value({0.3f, 0.6f, 0.1f});
        EXPECT_EQ(value.distance, std::numeric_limits<float>::max());
        EXPECT_EQ(value.color, hash_color(CellPoint<3>{}));  // of its own cell
    }
}

/// The border between two points is as far as half of the difference of the ways along it.
TEST(Voronoi, TellsTheWayToTheNearestBorder) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> anywhere(-9.0f, 9.0f);
    const Voronoi<3> voronoi({}, {1.0f, 0.5f, 0.0f, 0.0f, 0.5f, 2.0f}, false);
    for (int i = 0; i < 300; ++i) {
        CellPoint<3> place;
        for (float& x : place) x = anywhere(random);
        const auto ways = ways_to_all<3>(place, 1.0f, Metric::Euclidean, 2.0);
        const float edge = voronoi.edge(place);
        // Two points are at most as far from each other as both ways together.
        ASSERT_GE(edge, 0.5 * (ways[1] - ways[0]) - 2e-5) << i;
        // A step towards the border as long as it is far changes the nearest point on no side.
        for (int c = 0; c < 3; ++c)
            for (const float side : {-0.999f, 0.999f}) {
                CellPoint<3> beside = place;
                beside[static_cast<std::size_t>(c)] += side * edge;
                const auto position = voronoi.value(place).position;
                const auto there = voronoi.value(beside).position;
                ASSERT_NEAR(dot(difference(position, there), difference(position, there)), 0.0f,
                            1e-9f)
                    << i;
            }
    }
}

}  // namespace
}  // namespace granita
