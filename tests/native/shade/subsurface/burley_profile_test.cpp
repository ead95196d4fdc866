// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/subsurface/burley_profile.h"

#include <gtest/gtest.h>

namespace granita {
namespace {

const Vec3f kReach(2.0f, 0.7f, 0.0f);

TEST(BurleyProfile, IntegratesToOne) {
    const BurleyProfile profile(kReach);
    constexpr int kSteps = 400000;
    glm::dvec3 sum(0.0);
    double density = 0.0;
    const double step = profile.sample(0.0f).reach / kSteps;
    for (int k = 0; k < kSteps; ++k) {
        const double r = (k + 0.5) * step;
        sum += glm::dvec3(profile.value(static_cast<float>(r))) * step;
        density += profile.density(static_cast<float>(r)) * step;
    }
    EXPECT_NEAR(sum.x, 1.0, 1e-4);
    EXPECT_NEAR(sum.y, 1.0, 1e-4);
    EXPECT_EQ(sum.z, 0.0);
    EXPECT_NEAR(density, 1.0, 1e-4);
}

/// 1 - e^(-r/d)/4 - 3 e^(-r/3d)/4 of it lies within r (Christensen and Burley 2015), all within 16
/// d.
TEST(BurleyProfile, SamplesLieAsTheIntegralSays) {
    const BurleyProfile profile(kReach);
    const auto within = [](double r, double d) {
        const auto cdf = [](double x) {
            return 1.0 - 0.25 * std::exp(-x) - 0.75 * std::exp(-x / 3.0);
        };
        return cdf(std::min(r / d, 16.0)) / cdf(16.0);
    };
    constexpr int kSamples = 1 << 16;
    for (const double r : {0.1, 0.5, 2.0, 6.0, 20.0}) {
        int inside = 0;
        for (int k = 0; k < kSamples; ++k)
            inside += profile.sample((static_cast<float>(k) + 0.5f) / kSamples).r < r ? 1 : 0;
        const double expected = 0.5 * (within(r, 2.0) + within(r, 0.7));
        EXPECT_NEAR(static_cast<double>(inside) / kSamples, expected, 1e-3) << r;
    }
}

}  // namespace
}  // namespace granita
