// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/color_space.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/observer.h"

namespace granita {
namespace {

ColorSpace tabled(double (*curve)(double), int places, float low, float high) {
    ColorSpace space;
    space.curve = ColorSpace::Curve::Table;
    space.low = low;
    space.high = high;
    for (int i = 0; i < places; ++i)
        space.table.push_back(
            static_cast<float>(curve(low + (double{high} - low) * i / (places - 1))));
    return space;
}

TEST(ColorSpace, a_table_is_its_curve_and_a_power_goes_on_beyond_it) {
    const auto power = [](double x) { return x > 0.0 ? std::pow(x, 2.4) : 0.0; };
    const ColorSpace space = tabled(power, 10241, -0.5f, 2.0f);
    for (const float x : {-3.0f, -0.5f, 0.0f, 0.01f, 0.3f, 1.0f, 1.9999f, 2.0f, 3.0f, 12.0f}) {
        const double exact = power(x);
        EXPECT_NEAR(space.linear(Vec3f(x)).y, exact, 3e-6 + 1e-5 * exact) << x;
    }
}

TEST(ColorSpace, the_logarithm_of_film_has_its_stops) {
    // Middle grey lies 10 of 16.5 stops above black.
    const ColorSpace space =
        tabled([](double x) { return std::exp2(x * 16.5 - 12.473931188); }, 10241, -0.5f, 2.0f);
    EXPECT_NEAR(space.linear(Vec3f(10.0f / 16.5f)).x, 0.18, 1e-6);
}

TEST(ColorSpace, a_matrix_follows_the_curve) {
    ColorSpace space;
    space.matrix =
        Mat3f(Vec3f(0.25f, 1.0f, 0.0f), Vec3f(0.75f, 0.0f, 0.0f), Vec3f(0.0f, 0.0f, 2.0f));
    const Vec3f c = space.linear(Vec3f(1.0f, 0.0f, 0.5f));
    EXPECT_FLOAT_EQ(c.x, 0.25f);
    EXPECT_FLOAT_EQ(c.y, 1.0f);
    EXPECT_FLOAT_EQ(c.z, 2.0f * std::pow((0.5f + 0.055f) / 1.055f, 2.4f));  // IEC 61966-2-1
    EXPECT_FLOAT_EQ(space.linear(Vec3f(0.0f, 0.0f, -0.2f)).z, -0.4f / 12.92f);
    EXPECT_FALSE(space.is_plain());
    EXPECT_TRUE(ColorSpace{}.is_plain());
}

TEST(ColorSpace, a_cube_is_exact_where_colours_are_mixed_linearly) {
    constexpr int kSize = 5;
    const auto affine = [](const Vec3f& c) {
        return Vec3f(1.0f + 2.0f * c.x - c.y, 3.0f * c.y + c.z, 0.5f - 4.0f * c.z + c.x);
    };
    ColorSpace space;
    space.cube_size = kSize;
    for (int b = 0; b < kSize; ++b)
        for (int g = 0; g < kSize; ++g)
            for (int r = 0; r < kSize; ++r)
                space.cube.push_back(affine(Vec3f(r, g, b) / float(kSize - 1)));
    for (const Vec3f& c :
         {Vec3f(0.0f), Vec3f(1.0f), Vec3f(0.3f, 0.7f, 0.1f), Vec3f(0.9f, 0.2f, 0.6f),
          Vec3f(0.5f, 0.25f, 0.75f), Vec3f(0.11f, 0.12f, 0.13f)})
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(space.linear(c)[k], affine(c)[k], 2e-6f);
    const Vec3f beyond = space.linear(Vec3f(7.0f, -1.0f, std::nanf("")));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(beyond[k], affine(Vec3f(1.0f, 0.0f, 0.0f))[k], 2e-6f);
}

TEST(ColorSpace, three_have_names) {
    EXPECT_EQ(plain_color_space("sRGB")->curve, ColorSpace::Curve::Srgb);
    EXPECT_EQ(plain_color_space("scene_linear")->curve, ColorSpace::Curve::Linear);
    EXPECT_TRUE(plain_color_space("Non-Color")->is_data);
    EXPECT_FALSE(plain_color_space("AgX Base sRGB"));
}

// The white of daylight is white in each space of its white point; a grey keeps its luminance.
TEST(WorkingSpace, white_is_white) {
    WorkingSpace rec2020;
    rec2020.from_rec709 = glm::transpose(Mat3f(0.6274040f, 0.3292820f, 0.0433136f, 0.0690970f,
                                               0.9195400f, 0.0113612f, 0.0163916f, 0.0880132f,
                                               0.8955950f));  // ITU-R BT.2087
    rec2020.luminance = {0.2627f, 0.6780f, 0.0593f};          // BT.2020
    for (const WorkingSpace& colors : {WorkingSpace{}, rec2020}) {
        const Vec3f white = colors.from_xyz(Vec3f(0.95047f, 1.0f, 1.08883f));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(white[k], 1.0f, 1e-3f);
        EXPECT_NEAR(colors.number(white), 1.0f, 1e-3f);
        const Vec3f green(0.0f, 1.0f, 0.0f);
        EXPECT_NEAR(colors.number(colors.from_rec709 * green), 0.7152f, 1e-3f);
    }
}

}  // namespace
}  // namespace granita
