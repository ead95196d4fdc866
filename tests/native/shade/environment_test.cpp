// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/environment.h"

#include <gtest/gtest.h>

#include <limits>

#include "shade/light_scene.h"
#include "shade/sampling.h"

namespace granita {
namespace {

const Progress kProgress;

/// A dim sky with a bright cap of half-angle 3 degrees around `sun`.
const Vec3f kSun = glm::normalize(Vec3f(0.3f, -0.5f, 0.6f));
const float kSunCos = std::cos(0.0523599f);
Vec3f sky(const Vec3f& d) {
    return glm::dot(d, kSun) > kSunCos ? Vec3f(500.0f) : Vec3f(0.2f + 0.1f * d.z);
}

WorldEvaluator sunny() {
    return [](const std::vector<Vec3f>& directions, float, std::vector<Vec3f>& out) {
        out.clear();
        for (const Vec3f& d : directions) out.push_back(sky(d));
    };
}

TEST(Environment, tells_constant_black_and_varying_worlds_apart) {
    EXPECT_TRUE(Environment(constant_world(Vec3f(0.0f)), kProgress, 8).is_black());
    const Environment grey(constant_world(Vec3f(0.5f)), kProgress, 8);
    EXPECT_TRUE(grey.is_constant());
    EXPECT_FALSE(grey.is_black());
    EXPECT_EQ(grey.constant_radiance(), Vec3f(0.5f));
    EXPECT_FALSE(Environment(sunny(), kProgress, 128).is_constant());
}

TEST(Environment, density_integrates_to_one_and_matches_its_samples) {
    const Environment world(sunny(), kProgress, 64);
    // 2048 x 1024 cells of equal solid angle resolve the 128 x 64 table.
    double integral = 0.0;
    const int w = 2048, h = 1024;
    for (int j = 0; j < h; ++j)
        for (int i = 0; i < w; ++i) {
            const float z = -1.0f + 2.0f * (static_cast<float>(j) + 0.5f) / h;
            const float phi = 2 * kPi * (static_cast<float>(i) + 0.5f) / w;
            const float s = std::sqrt(1 - z * z);
            integral += world.pdf({s * std::cos(phi), s * std::sin(phi), z});
        }
    EXPECT_NEAR(integral * 4 * kPi / (static_cast<double>(w) * h), 1.0, 0.01);
    const SobolPoints points(1);
    int equal = 0;
    for (std::uint32_t i = 0; i < 1024; ++i) {
        float pdf = 0.0f;
        const Vec3f direction = world.sample(points(i), pdf);
        EXPECT_NEAR(glm::length(direction), 1.0f, 1e-5f);
        equal += std::abs(world.pdf(direction) / pdf - 1.0f) < 1e-2f;
    }
    EXPECT_GE(equal, 1020);  // a sample on a texel's border may be rounded into the next
}

TEST(Environment, samples_estimate_the_irradiance_of_a_small_sun) {
    const Environment world(sunny(), kProgress);
    const SobolPoints points(2);
    const std::uint32_t count = 1 << 14;
    double sum = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
        float pdf = 0.0f;
        const Vec3f direction = world.sample(points(i), pdf);
        if (pdf > 0.0f) sum += std::max(0.0f, direction.z) * sky(direction).x / pdf;
    }
    // Cap: L pi sin^2(a) cos(tilt), less the sky it hides; sky: pi (0.2 + 0.1 * 2/3).
    const double s2 = 1.0 - static_cast<double>(kSunCos) * kSunCos;
    const double hidden = 0.2 + 0.1 * kSun.z;
    const double expected = kPi * (0.2 + 0.1 * 2.0 / 3.0) + (500.0 - hidden) * kPi * s2 * kSun.z;
    EXPECT_NEAR(sum / count, expected, 0.01 * expected);
}

TEST(Environment, directions_that_are_not_finite_count_as_black) {
    const WorldEvaluator broken = [](const std::vector<Vec3f>& d, float, std::vector<Vec3f>& out) {
        out.clear();
        for (const Vec3f& v : d)
            out.emplace_back(v.z > 0 ? std::numeric_limits<float>::quiet_NaN() : 1.0f);
    };
    const Environment world(broken, kProgress, 32);
    EXPECT_EQ(world.broken(), 32u * 32u);
    const SobolPoints points(4);
    for (std::uint32_t i = 0; i < 256; ++i) {
        float pdf = 0.0f;
        EXPECT_LT(world.sample(points(i), pdf).z, 0.15f);  // one texel blurs across the horizon
        EXPECT_TRUE(std::isfinite(pdf));
    }
}

TEST(Environment, stops_when_cancelled) {
    Progress progress;
    progress.cancel();
    EXPECT_THROW(Environment(sunny(), progress, 64), Cancelled);
}

}  // namespace
}  // namespace granita
