// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/ray_ways.h"

#include <gtest/gtest.h>

#include <limits>

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
const Bounds3f kCube{Vec3f(-1), Vec3f(1)};
const Vec3f kX(1, 0, 0), kZ(0, 0, 1);

Mat4d at(double x, double y, double z) {
    Mat4d m(1.0);
    m[3] = glm::dvec4(x, y, z, 1.0);
    return m;
}

TEST(RayWays, a_segment_meets_what_is_swept_between_the_knots_and_nothing_beside) {
    RayWays ways;
    EXPECT_FALSE(ways.meet({0, 0, -5}, kZ, kInfinity));
    ways.add(kCube, {at(0, 0, 0), at(10, 0, 0)});
    EXPECT_TRUE(ways.meet({5, 0, -5}, kZ, kInfinity));
    EXPECT_FALSE(ways.meet({5, 0, -5}, -kZ, kInfinity));
    EXPECT_FALSE(ways.meet({5, 0, -5}, kZ, 3.9f));
    EXPECT_TRUE(ways.meet({5, 0, -5}, kZ, 4.1f));
    EXPECT_FALSE(ways.meet({5, 1.1f, -5}, kZ, kInfinity));
    EXPECT_FALSE(ways.meet({11.1f, 0, -5}, kZ, kInfinity));
    EXPECT_TRUE(ways.meet({-9, 0, 0}, kX, kInfinity));
    EXPECT_TRUE(ways.meet({5, 0, 0}, kZ, 0.1f)) << "from inside";
}

TEST(RayWays, a_ray_in_the_plane_of_a_side_counts_as_meeting_it) {
    RayWays ways;
    ways.add(kCube, {at(0, 0, 0)});
    EXPECT_TRUE(ways.meet({1, 0, -5}, kZ, kInfinity));
}

TEST(RayWays, of_many_none_is_lost) {
    RayWays ways;
    for (int i = 0; i < 40; ++i) ways.add(kCube, {at(10 * i, 0, 0)});
    for (int i = 0; i < 40; ++i)
        EXPECT_TRUE(ways.meet({static_cast<float>(10 * i), 0, -5}, kZ, kInfinity)) << i;
    EXPECT_FALSE(ways.meet({5, 0, -5}, kZ, kInfinity)) << "between the first two";
    EXPECT_FALSE(ways.meet({0, 5, -5}, kZ, kInfinity));
}

TEST(RayWays, an_empty_box_is_nowhere) {
    RayWays ways;
    ways.add(Bounds3f{}, {at(0, 0, 0)});
    EXPECT_FALSE(ways.meet({0, 0, -5}, kZ, kInfinity));
    EXPECT_TRUE(ways.empty());
}

}  // namespace
}  // namespace granita
