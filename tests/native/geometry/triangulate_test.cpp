// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace granita {
namespace {

double area(std::span<const Vec3f> p, const Triangulation& t) {
    double sum = 0.0;
    for (const auto& [a, b, c] : t.triangles)
        sum += 0.5 *
               glm::length(glm::cross(
                   Vec3d(p[static_cast<std::size_t>(b)]) - Vec3d(p[static_cast<std::size_t>(a)]),
                   Vec3d(p[static_cast<std::size_t>(c)]) - Vec3d(p[static_cast<std::size_t>(a)])));
    return sum;
}

TEST(Triangulate, star_polygons_keep_their_area) {
    // Star-shaped about the origin, so simple, with half of the corners turning inwards.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> radius(0.2, 1.0);
    for (int n = 4; n < 60; ++n) {
        std::vector<Vec3f> p;
        for (int i = 0; i < n; ++i) {
            const double r = radius(random), a = i * 2 * M_PI / n;
            p.emplace_back(0.6 * r * std::cos(a), 0.8 * r * std::cos(a), r * std::sin(a));
        }
        double shoelace = 0.0;
        for (int i = 0; i < n; ++i)
            shoelace +=
                0.5 * glm::length(glm::cross(Vec3d(p[static_cast<std::size_t>(i)]),
                                             Vec3d(p[static_cast<std::size_t>((i + 1) % n)])));
        const Triangulation t = triangulate(p);
        EXPECT_TRUE(t.simple) << n;
        EXPECT_EQ(t.triangles.size(), static_cast<std::size_t>(n - 2));
        EXPECT_NEAR(area(p, t), shoelace, 1e-6) << n;
    }
}

TEST(Triangulate, corners_on_a_line_and_twice_the_same_corner) {
    const std::vector<Vec3f> p = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0},
                                  {3, 0, 0}, {3, 2, 0}, {1, 2, 0}, {0, 2, 0}};
    const Triangulation t = triangulate(p);
    EXPECT_TRUE(t.simple);
    EXPECT_EQ(t.triangles.size(), 6u);
    EXPECT_NEAR(area(p, t), 6.0, 1e-6);
}

TEST(Triangulate, what_crosses_itself_or_has_no_area_becomes_a_fan) {
    const std::vector<Vec3f> bow = {{0, 0, 0}, {4, 0, 0}, {1, 2, 0}, {3, 3, 0}};
    const std::vector<Vec3f> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    EXPECT_FALSE(triangulate(bow).simple);
    EXPECT_FALSE(triangulate(line).simple);
    EXPECT_EQ(triangulate(bow).triangles.size(), 2u);
    EXPECT_EQ(triangulate(line).triangles.size(), 2u);
}

TEST(Triangulate, quads_are_cut_from_their_first_corner_unless_that_turns_a_triangle_over) {
    const auto cut = [](std::vector<Vec3f> quad) {
        return triangulate_quad(std::span<const Vec3f, 4>(quad), false);
    };
    const QuadTriangles bent = cut({{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}});
    EXPECT_EQ(bent.start, 0);
    EXPECT_NEAR(bent.cosine, 0.5, 1e-12);  // of (0, -1, 1) and (-1, 0, 1)
    const QuadTriangles dart = cut({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}});
    EXPECT_EQ(dart.start, 0);
    EXPECT_NEAR(dart.cosine, 1.0, 1e-12);
    const QuadTriangles turned = cut({{0, 4, 0}, {0, 0, 0}, {4, 0, 0}, {1, 1, 0}});
    EXPECT_EQ(turned.start, 1);
    EXPECT_NEAR(turned.cosine, 1.0, 1e-12);
    // A bow tie has no good cut; a corner on an edge leaves one triangle.
    EXPECT_LT(cut({{0, 0, 0}, {4, 0, 0}, {1, 2, 0}, {3, 3, 0}}).cosine, 0.0);
    EXPECT_EQ(cut({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {0, 4, 0}}).cosine, 1.0);
}

TEST(Triangulate, steep_roofs_keep_their_ridge_where_the_normal_decides) {
    const auto start = [](std::vector<Vec3f> quad, bool by_normal) {
        return triangulate_quad(std::span<const Vec3f, 4>(quad), by_normal).start;
    };
    // The ridge goes from the first corner to the third; its sides fall by 45 degrees at a height
    // of 1.
    const auto roof = [](float height) {
        return std::vector<Vec3f>{{0, -1, height}, {1, 0, 0}, {0, 1, height}, {-1, 0, 0}};
    };
    EXPECT_EQ(start(roof(0.9f), false), 0);
    EXPECT_EQ(start(roof(1.1f), false), 1);
    EXPECT_EQ(start(roof(0.9f), true), 0);
    EXPECT_EQ(start(roof(1.1f), true), 0);
    // A corner inside of the other three, and one on their edge.
    EXPECT_EQ(start({{0, 4, 0}, {0, 0, 0}, {4, 0, 0}, {1, 1, 0}}, true), 1);
    EXPECT_EQ(start({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {0, 4, 0}}, true), 1);
}

}  // namespace
}  // namespace granita
