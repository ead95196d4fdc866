// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_transforms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace granita {
namespace {

Mat4d scaled(double x, double y, double z, Vec3d place = Vec3d(0)) {
    Mat4d m(1.0);
    m[0][0] = x, m[1][1] = y, m[2][2] = z;
    m[3] = glm::dvec4(place, 1.0);
    return m;
}

double volume(const Mat4d& m) {
    return glm::determinant(Mat3d(m));
}

TEST(RayTransforms, what_stands_still_has_one_knot_in_shading_space) {
    const Mat4d m = scaled(2, 3, -0.5, {10, 20, 30});
    const auto made = ray_transforms({m, m, m}, {7, 16, 30});
    ASSERT_TRUE(made);
    ASSERT_EQ(made->knots.size(), 1u);
    EXPECT_EQ(made->knots[0], scaled(2, 3, -0.5, {3, 4, 0}));
    EXPECT_EQ(made->columns,
              (std::vector<std::array<float, 12>>{{2, 0, 0, 0, 3, 0, 0, 0, -0.5f, 3, 4, 0}}));
    EXPECT_EQ(made->scale, 3.0f);
    EXPECT_EQ(made->distance, 5.0f);
}

TEST(RayTransforms, the_largest_scale_and_distance_of_any_knot_count) {
    const auto made = ray_transforms({scaled(1, 1, 1, {9, 0, 0}), scaled(4, 1, 1, {0, 2, 0})}, {});
    ASSERT_TRUE(made);
    EXPECT_EQ(made->knots.size(), 2u);
    EXPECT_EQ(made->scale, 4.0f);
    EXPECT_EQ(made->distance, 9.0f);
}

TEST(RayTransforms, what_never_has_volume_casts_nothing) {
    EXPECT_FALSE(ray_transforms({scaled(1, 1, 0)}, {}));
    EXPECT_FALSE(ray_transforms({scaled(1, 1, 1e-10)}, {}));
    EXPECT_FALSE(ray_transforms({scaled(1e-13, 1e-13, 1e-13)}, {}));
    EXPECT_FALSE(ray_transforms({scaled(1, 0, 1), scaled(2, 0, 1)}, {}));
    EXPECT_TRUE(ray_transforms({scaled(1e-3, 1e-3, 1e-6)}, {}));
}

TEST(RayTransforms, what_loses_its_volume_for_a_while_keeps_some_at_every_knot_and_between) {
    // Mirrored, flat at a knot, and half a turn about z, of which the chord's middle is a line.
    const std::vector<std::vector<Mat4d>> motions = {{scaled(1, 1, 1), scaled(1, 1, -1)},
                                                     {scaled(1, 1, 0), scaled(1, 1, 1)},
                                                     {scaled(1, 1, 1), scaled(-1, -1, 1)}};
    for (const auto& motion : motions) {
        const auto made = ray_transforms(motion, {});
        ASSERT_TRUE(made);
        for (const Mat4d& m :
             {made->knots[0], made->knots[1], 0.5 * (made->knots[0] + made->knots[1])})
            EXPECT_GT(std::abs(volume(m)), 1e-21);
        for (std::size_t k = 0; k < motion.size(); ++k)
            for (int c = 0; c < 3; ++c)
                EXPECT_LT(glm::length(made->knots[k][c] - motion[k][c]), 1e-6);
    }
}

TEST(RayTransforms, what_keeps_its_volume_is_left_as_it_is) {
    const std::vector<Mat4d> way = {scaled(1, 1, -1), scaled(2, 1, -1)};
    EXPECT_EQ(ray_transforms(way, {})->knots, way);
}

TEST(RayTransforms, numbers_that_are_too_large_for_floats_cast_nothing) {
    EXPECT_FALSE(ray_transforms({scaled(1, 1, 1, {1e39, 0, 0})}, {}));
    EXPECT_FALSE(ray_transforms({scaled(1e39, 1e39, 1e39)}, {}));
}

TEST(RayTransforms, more_knots_than_rays_can_have_are_read_off_the_same_way) {
    std::vector<Mat4d> way;
    for (int k = 0; k < 257; ++k) way.push_back(scaled(1, 1, 1, {k, 0, 0}));
    const auto made = ray_transforms(way, {});
    ASSERT_TRUE(made);
    ASSERT_LT(made->knots.size(), way.size());
    const auto last = static_cast<double>(made->knots.size() - 1);
    for (std::size_t k = 0; k < made->knots.size(); ++k)
        EXPECT_NEAR(made->knots[k][3].x, 256.0 * static_cast<double>(k) / last, 1e-9);
}

}  // namespace
}  // namespace granita
