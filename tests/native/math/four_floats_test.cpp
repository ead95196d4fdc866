// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/four_floats.h"

#include <gtest/gtest.h>

#include <cmath>

namespace granita {
namespace {

TEST(FourFloats, exponential_is_that_of_the_library) {
    for (float x = -87.0f; x < 88.0f; x += 0.0137f) {
        const Floats four = exponential(Floats{x, -x, 0.5f * x, 0.0f});
        EXPECT_NEAR(four[0] / std::exp(x), 1.0f, 4e-7f) << x;
        if (x <= 87.0f)
            EXPECT_NEAR(four[1] / std::exp(-x), 1.0f, 4e-7f) << x;
        else
            EXPECT_EQ(four[1], 0.0f) << x;
        EXPECT_NEAR(four[2] / std::exp(0.5f * x), 1.0f, 4e-7f) << x;
        EXPECT_EQ(four[3], 1.0f);
    }
    const Floats ends = exponential(Floats{-1e30f, -88.0f, 1e30f, NAN});
    EXPECT_EQ(ends[0], 0.0f);
    EXPECT_EQ(ends[1], 0.0f);
    EXPECT_NEAR(ends[2] / std::exp(88.0f), 1.0f, 4e-7f);
    EXPECT_TRUE(std::isnan(ends[3]));
}

TEST(FourFloats, arc_sine_is_that_of_the_library) {
    for (float x = -1.0f; x <= 1.0f; x += 0.0003f) {
        const Floats four = arc_sine(Floats{x, -x, 1.0f, -1.0f});
        EXPECT_NEAR(four[0], std::asin(x), 4e-7f) << x;
        EXPECT_EQ(four[1], -four[0]) << x;
        EXPECT_FLOAT_EQ(four[2], std::asin(1.0f));
        EXPECT_FLOAT_EQ(four[3], -std::asin(1.0f));
    }
}

TEST(FourFloats, nearest_rounds_halves_away_from_zero) {
    const Ints n = nearest(Floats{0.49f, 0.5f, -0.5f, -7.2f});
    EXPECT_EQ(n[0], 0);
    EXPECT_EQ(n[1], 1);
    EXPECT_EQ(n[2], -1);
    EXPECT_EQ(n[3], -7);
}

}  // namespace
}  // namespace granita
