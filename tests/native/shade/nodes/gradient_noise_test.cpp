// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/gradient_noise.h"

#include <gtest/gtest.h>

#include <random>

namespace granita {
namespace {

template <std::size_t N>
float largest_of_many() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-1000.0f, 1000.0f);
    float most = 0.0f;
    for (int i = 0; i < 300'000; ++i) {
        NoisePoint<N> p;
        for (float& x : p) x = place(random);
        most = std::max(most, std::abs(signed_noise<N>(p)));
    }
    return most;
}

TEST(GradientNoise, is_never_larger_than_is_told_of_it) {
    EXPECT_LE(largest_of_many<1>(), noise_detail::kMost[0]);
    EXPECT_LE(largest_of_many<2>(), noise_detail::kMost[1]);
    EXPECT_LE(largest_of_many<3>(), noise_detail::kMost[2]);
    EXPECT_LE(largest_of_many<4>(), noise_detail::kMost[3]);
}

TEST(GradientNoise, is_nothing_at_lattice_points_and_beyond_what_integers_hold) {
    for (const float x : {0.0f, -3.0f, 7.0f, 3e9f, -1e20f})
        EXPECT_EQ(signed_noise<3>({x, x, x}), 0.0f) << x;
}

}  // namespace
}  // namespace granita
