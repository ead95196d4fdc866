// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/instance_motion.h"

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

TEST(InstanceMotion, a_segment_meets_what_is_swept_between_the_knots_and_nothing_beside) {
    InstanceMotion motion;
    EXPECT_FALSE(motion.meet({0, 0, -5}, kZ, kInfinity));
    motion.add(kCube, {at(0, 0, 0), at(10, 0, 0)});
    EXPECT_TRUE(motion.meet({5, 0, -5}, kZ, kInfinity));
    EXPECT_FALSE(motion.meet({5, 0, -5}, -kZ, kInfinity));
    EXPECT_FALSE(motion.meet({5, 0, -5}, kZ, 3.9f));
    EXPECT_TRUE(motion.meet({5, 0, -5}, kZ, 4.1f));
    EXPECT_FALSE(motion.meet({5, 1.1f, -5}, kZ, kInfinity));
    EXPECT_FALSE(motion.meet({11.1f, 0, -5}, kZ, kInfinity));
    EXPECT_TRUE(motion.meet({-9, 0, 0}, kX, kInfinity));
    EXPECT_TRUE(motion.meet({5, 0, 0}, kZ, 0.1f)) << "from inside";
}

TEST(InstanceMotion, a_ray_in_the_plane_of_a_side_counts_as_meeting_it) {
    InstanceMotion motion;
    motion.add(kCube, {at(0, 0, 0)});
    EXPECT_TRUE(motion.meet({1, 0, -5}, kZ, kInfinity));
}

TEST(InstanceMotion, of_many_none_is_lost) {
    InstanceMotion motion;
    for (int i = 0; i < 40; ++i) motion.add(kCube, {at(10 * i, 0, 0)});
    for (int i = 0; i < 40; ++i)
        EXPECT_TRUE(motion.meet({static_cast<float>(10 * i), 0, -5}, kZ, kInfinity)) << i;
    EXPECT_FALSE(motion.meet({5, 0, -5}, kZ, kInfinity)) << "between the first two";
    EXPECT_FALSE(motion.meet({0, 5, -5}, kZ, kInfinity));
}

TEST(InstanceMotion, an_empty_box_is_nowhere) {
    InstanceMotion motion;
    motion.add(Bounds3f{}, {at(0, 0, 0)});
    EXPECT_FALSE(motion.meet({0, 0, -5}, kZ, kInfinity));
    EXPECT_TRUE(motion.empty());
}

}  // namespace
}  // namespace granita
