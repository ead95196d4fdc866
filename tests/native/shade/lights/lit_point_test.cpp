// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lit_point.h"

#include <gtest/gtest.h>

#include <array>

#include "shade/bsdf/bsdf_albedo.h"

namespace granita {
namespace {

constexpr std::array<float, 4> kWeights{0.7f, 0.2f, 0.07f, 0.03f};

/// Matte lobes of these weights.
struct Matte {
    Matte() {
        points.count = 1;
        points.p = {Vec3f(0.0f)};
        points.normal = points.geometric_normal = points.view = {Vec3f(0.0f, 0.0f, 1.0f)};
        points.dp_du = {Vec3f(1.0f, 0.0f, 0.0f)};
        points.dp_dv = {Vec3f(0.0f, 1.0f, 0.0f)};
        for (const float weight : kWeights) {
            Lobe& lobe = closure.lobes.emplace_back();
            lobe.weight = {Vec3f(weight)};
            lobe.normal = points.normal;
            lobe.roughness = {0.0f};
        }
    }
    LitPoint lit(int samples) const {
        return {0,     PointBsdf(closure, points, 0, GgxAlbedo::shared()),
                paths, {},
                {},    samples,
                0,     {},
                {},    nullptr,
                0.0f,  0.0f,
                false, {}};
    }

    ShadingPoints points;
    SurfaceClosure closure;
    PointPaths paths;
};

TEST(LitPoint, corners_have_a_sample_of_each_lobe_at_least) {
    const Matte matte;
    LitPoint point = matte.lit(16);
    point.share_samples(std::nullopt);
    const std::array<int, 4> counts{11, 3, 1, 1};
    for (std::size_t k = 0; k < counts.size(); ++k) {
        EXPECT_EQ(point.samples[k].count, counts[k]);
        EXPECT_EQ(point.samples[k].expected, static_cast<float>(counts[k]));
    }
}

// Of 10,000 numbers evenly over [0, 1): no chance but for rounding.
TEST(LitPoint, a_sample_takes_lobes_twice_as_often_as_they_weigh) {
    const Matte matte;
    LitPoint point = matte.lit(1);
    constexpr int kNumbers = 10000;
    std::array<double, 4> means{};
    for (int i = 0; i < kNumbers; ++i) {
        point.share_samples((static_cast<float>(i) + 0.5f) / kNumbers);
        for (std::size_t k = 0; k < means.size(); ++k)
            means[k] += static_cast<double>(point.samples[k].count) / kNumbers;
    }
    const std::array<double, 4> expected{1.0, 0.4, 0.14, 0.125};
    for (std::size_t k = 0; k < means.size(); ++k) {
        EXPECT_NEAR(means[k], expected[k], 2e-4);
        EXPECT_NEAR(point.samples[k].expected, expected[k], 1e-6);
    }
    // Straight up each has a density of 1 / pi.
    EXPECT_NEAR(point.all_density({0.0f, 0.0f, 1.0f}), 1.665 / 3.14159265, 1e-4);
}

}  // namespace
}  // namespace granita
