// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/scattering_medium.h"

#include <gtest/gtest.h>

#include <vector>

namespace granita {
namespace {

/// Share of diffuse light that a half-space of isotropic scattering sends back, exactly:
/// 1 - 2 sqrt(1 - w) times the first moment of Chandrasekhar's H (1960, "Radiative Transfer",
/// section 33), which is iterated.
double spherical_albedo(double w) {
    constexpr int kPoints = 400;
    std::vector<double> h(kPoints, 1.0), next(kPoints);
    const auto at = [](int i) { return (i + 0.5) / kPoints; };
    for (int turn = 0; turn < 200; ++turn) {
        for (int i = 0; i < kPoints; ++i) {
            double sum = 0.0;
            for (int j = 0; j < kPoints; ++j) sum += at(j) * h[j] / (at(i) + at(j));
            next[i] = 1.0 / (std::sqrt(1.0 - w) + 0.5 * w * sum / kPoints);
        }
        h.swap(next);
    }
    double moment = 0.0;
    for (int i = 0; i < kPoints; ++i) moment += at(i) * h[i] / kPoints;
    return 1.0 - 2.0 * std::sqrt(1.0 - w) * moment;
}

TEST(ScatteringMedium, HalfSpaceSendsBackTheAlbedoAskedFor) {
    for (const float albedo : {0.05f, 0.2f, 0.5f, 0.8f, 0.95f})
        EXPECT_NEAR(spherical_albedo(single_scattering_albedo(albedo, 0.0f)), albedo, 0.003);
}

// What is absorbed stays; of what is scattered that which turns back counts.
TEST(ScatteringMedium, AnEvenOneLikeItLetsLightComeAsFar) {
    const ScatteringMedium medium(Vec3f(0.2f, 0.8f, 1.0f), Vec3f(0.1f, 0.2f, 0.4f), 0.85f);
    const ScatteringMedium even = medium.isotropic();
    EXPECT_EQ(even.g, 0.0f);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(even.extinction[c] * (1.0f - even.albedo[c]),
                    medium.extinction[c] * (1.0f - medium.albedo[c]), 1e-4f);
        EXPECT_NEAR(even.extinction[c] * even.albedo[c],
                    medium.extinction[c] * medium.albedo[c] * 0.15f, 1e-4f);
    }
}

TEST(ScatteringMedium, EndsOfTheScale) {
    EXPECT_NEAR(single_scattering_albedo(0.0f, 0.0f), 0.0f, 0.01f);
    EXPECT_EQ(single_scattering_albedo(1.0f, 0.0f), 1.0f);
    EXPECT_EQ(single_scattering_albedo(1.0f, 0.8f), 1.0f);
    EXPECT_EQ(single_scattering_albedo(7.0f, 0.0f), 1.0f);
}

/// (1 - w) / (1 - g w) is what a half-space depends on.
TEST(ScatteringMedium, ForwardScatteringIsSimilar) {
    const float plain = single_scattering_albedo(0.6f, 0.0f);
    const float forward = single_scattering_albedo(0.6f, 0.7f);
    EXPECT_GT(forward, plain);
    EXPECT_NEAR((1.0f - forward) / (1.0f - 0.7f * forward), 1.0f - plain, 1e-5f);
}

/// Jensen et al. 2001, section 2.4, put in again.
TEST(ScatteringMedium, MeanFreeShareReflectsTheAlbedo) {
    for (const float albedo : {0.1f, 0.5f, 0.9f})
        for (const double ior : {1.01, 1.4, 2.0}) {
            const double s = mean_free_share(albedo, static_cast<float>(ior));
            const double f = -1.44 / (ior * ior) + 0.71 / ior + 0.668 + 0.0636 * ior;
            const double a = (1.0 + f) / (1.0 - f), reduced = 1.0 - s * s / 3.0;
            EXPECT_NEAR(0.5 * reduced * (1.0 + std::exp(-4.0 / 3.0 * a * s)) * std::exp(-s), albedo,
                        1e-4);
        }
}

}  // namespace
}  // namespace granita
