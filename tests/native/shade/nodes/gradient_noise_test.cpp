// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/gradient_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace granita {
namespace {

/// Of Perlin's gradients over an offset, by its components' sizes from the smallest on: of one axis
/// eight, of two one and twice the other, else all but the smallest of four, or of three.
template <std::size_t N>
double steepest(std::array<double, N> d) {
    for (double& x : d) x = std::abs(x);
    std::ranges::sort(d);
    if constexpr (N == 1) return 8.0 * d[0];
    if constexpr (N == 2) return d[0] + 2.0 * d[1];
    double sum = 0.0;
    for (std::size_t c = 1; c < N; ++c) sum += d[c];
    return sum;
}

/// At a place of a cell whose corners all have their steepest gradients.
template <std::size_t N>
double largest_at(const std::array<double, N>& p) {
    double sum = 0.0;
    for (std::size_t corner = 0; corner < (std::size_t{1} << N); ++corner) {
        std::array<double, N> offset;
        double weight = 1.0;
        for (std::size_t c = 0; c < N; ++c) {
            const bool is_far = (corner >> c & 1u) != 0;
            const double t = p[c], fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
            weight *= is_far ? fade : 1.0 - fade;
            offset[c] = is_far ? t - 1.0 : t;
        }
        sum += weight * steepest<N>(offset);
    }
    return sum * static_cast<double>(noise_detail::kScales[N - 1]);
}

/// By symmetry, places of half a cell whose components do not fall.
template <std::size_t N>
double largest_from(std::array<double, N>& p, std::size_t c) {
    constexpr int kSteps = 30;
    if (c == N) return largest_at<N>(p);
    double most = 0.0;
    const int first = c == 0 ? 0 : static_cast<int>(std::lround(p[c - 1] * 2 * kSteps));
    for (int k = first; k <= kSteps; ++k) {
        p[c] = 0.5 * k / kSteps;
        most = std::max(most, largest_from<N>(p, c + 1));
    }
    return most;
}

template <std::size_t N>
void expect_told() {
    std::array<double, N> p{};
    const double most = largest_from<N>(p, 0);
    const double told = static_cast<double>(noise_detail::kMost[N - 1]);
    EXPECT_LE(most, told) << N;
    EXPECT_GE(most, told - 0.02) << N;  // and not much less
}

TEST(GradientNoise, is_told_to_be_as_large_as_gradients_make_it) {
    expect_told<1>();
    expect_told<2>();
    expect_told<3>();
    expect_told<4>();
}

template <std::size_t N>
void expect_no_larger() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> anywhere(-1000.0f, 1000.0f);
    for (int i = 0; i < 100'000; ++i) {
        NoisePoint<N> p;
        std::array<double, N> inside;
        for (std::size_t c = 0; c < N; ++c) {
            p[c] = anywhere(random);
            inside[c] = static_cast<double>(p[c] - std::floor(p[c]));
        }
        ASSERT_LE(std::abs(signed_noise<N>(p)), largest_at<N>(inside) + 1e-5) << N;
    }
}

TEST(GradientNoise, is_nowhere_larger_than_gradients_can_make_it_there) {
    expect_no_larger<1>();
    expect_no_larger<2>();
    expect_no_larger<3>();
    expect_no_larger<4>();
}

TEST(GradientNoise, is_nothing_at_lattice_points_and_beyond_what_integers_hold) {
    for (const float x : {0.0f, -3.0f, 7.0f, 3e9f, -1e20f})
        EXPECT_EQ(signed_noise<3>({x, x, x}), 0.0f) << x;
}

}  // namespace
}  // namespace granita
