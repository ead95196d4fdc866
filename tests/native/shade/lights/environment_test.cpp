// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/environment.h"

#include <gtest/gtest.h>

#include <limits>

#include "math/sampling.h"
#include "shade/lights/light_scene.h"

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
    return world_of(sky);
}

TEST(Environment, tells_constant_black_and_varying_worlds_apart) {
    EXPECT_TRUE(Environment(constant_world(Vec3f(0.0f)), kProgress, 8).is_black());
    const Environment grey(constant_world(Vec3f(0.5f)), kProgress, 8);
    EXPECT_TRUE(grey.is_constant());
    EXPECT_FALSE(grey.is_black());
    EXPECT_EQ(grey.constant_radiance(RayType::Diffuse), Vec3f(0.5f));
    EXPECT_FALSE(Environment(sunny(), kProgress, 128).is_constant());
    // Whatever its texels hold.
    const Environment dark(world_of([](const Vec3f&) { return Vec3f(0.0f); }), kProgress, 8);
    EXPECT_FALSE(dark.is_constant());
    EXPECT_FALSE(dark.is_black());
    EXPECT_FALSE(dark.has_density());
    EXPECT_EQ(dark.at(kSun).pdf, 0.0f);
}

// A disc is found wherever it stands, if it is as wide as the places of a texel are apart.
TEST(Environment, a_disc_of_an_eighth_of_a_degree_is_sampled_in_a_black_world) {
    const float cosine = std::cos(0.0625f * kPi / 180.0f);
    const SobolPoints places(7);
    for (std::uint32_t k = 0; k < 8; ++k) {
        const float z = 2.0f * places(k).x - 1.0f, phi = 2.0f * kPi * places(k).y;
        const Vec3f sun(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi),
                        z);
        const Environment world(world_of([&](const Vec3f& d) {
                                    return Vec3f(glm::dot(d, sun) > cosine ? 1.0f : 0.0f);
                                }),
                                kProgress);
        ASSERT_TRUE(world.has_density());
        // All samples fall on texels that the disc touches: at most three of .35 degrees wide.
        EXPECT_LT(glm::distance(world.sample(places(k + 100)).direction, sun), 0.02f);
    }
}

TEST(Environment, its_density_covers_what_any_kind_of_lobe_sees) {
    WorldEvaluator world{[](const std::vector<Vec3f>& directions, float, RayType ray,
                            std::vector<Vec3f>& out) {
        out.clear();
        const bool sees_all = goes_through(ray) || ray == RayType::Scattered;
        for (const Vec3f& d : directions)
            out.emplace_back(sees_all || (ray == RayType::Glossy) == (d.z > 0.0f) ? 1.0f : 0.0f);
    }};
    world.by_lobe = true;
    const Environment environment(world, kProgress, 32);
    EXPECT_NEAR(environment.at(Vec3f(0.6f, 0.0f, 0.8f)).pdf, 1.0f / (4.0f * kPi), 1e-3f);
    EXPECT_NEAR(environment.at(Vec3f(0.6f, 0.0f, -0.8f)).pdf, 1.0f / (4.0f * kPi), 1e-3f);
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
            integral += world.at({s * std::cos(phi), s * std::sin(phi), z}).pdf;
        }
    EXPECT_NEAR(integral * 4 * kPi / (static_cast<double>(w) * h), 1.0, 0.01);
    const SobolPoints points(1);
    int equal = 0;
    for (std::uint32_t i = 0; i < 1024; ++i) {
        const Environment::Sample sample = world.sample(points(i));
        const Environment::Sample found = world.at(sample.direction);
        EXPECT_NEAR(glm::length(sample.direction), 1.0f, 1e-5f);
        equal += found.texel == sample.texel && std::abs(found.pdf / sample.pdf - 1.0f) < 1e-2f;
    }
    EXPECT_GE(equal, 1020);  // a sample on a texel's border may be rounded into the next
}

TEST(Environment, samples_estimate_the_irradiance_of_a_small_sun) {
    const Environment world(sunny(), kProgress);
    const SobolPoints points(2);
    const std::uint32_t count = 1 << 14;
    double sum = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Environment::Sample sample = world.sample(points(i));
        if (sample.pdf > 0.0f)
            sum += std::max(0.0f, sample.direction.z) * sky(sample.direction).x / sample.pdf;
    }
    // Cap: L pi sin^2(a) cos(tilt), less the sky it hides; sky: pi (0.2 + 0.1 * 2/3).
    const double s2 = 1.0 - static_cast<double>(kSunCos) * kSunCos;
    const double hidden = 0.2 + 0.1 * kSun.z;
    const double expected = kPi * (0.2 + 0.1 * 2.0 / 3.0) + (500.0 - hidden) * kPi * s2 * kSun.z;
    EXPECT_NEAR(sum / count, expected, 0.01 * expected);
}

// The sun as it is seen lies in four texels, in part; half of the samples of these missed it.
TEST(Environment, few_samples_miss_a_sun_of_half_a_degree) {
    const float cosine = std::cos(0.0046f);
    const SobolPoints places(7), points(2);
    for (std::uint32_t k = 0; k < 8; ++k) {
        const Vec3f sun = glm::normalize(Vec3f(places(k).x - 0.5f, places(k).y - 0.5f, 0.4f));
        const auto shines = [&](const Vec3f& d) { return glm::dot(d, sun) > cosine; };
        const auto radiance = [&](const Vec3f& d) { return shines(d) ? 1e5f : 0.3f; };
        const Environment world(world_of([&](const Vec3f& d) { return Vec3f(radiance(d)); }),
                                kProgress);
        double sum = 0.0, squares = 0.0;
        const std::uint32_t count = 1 << 12;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Environment::Sample sample = world.sample(points(i));
            const double light = radiance(sample.direction) / sample.pdf;
            sum += light / count;
            squares += light * light / count;
        }
        const double expected = 4 * kPi * 0.3 + 1e5 * 2 * kPi * (1.0 - std::cos(0.0046));
        EXPECT_NEAR(sum, expected, 0.01 * expected);
        EXPECT_LT(squares / (sum * sum) - 1.0, 0.15) << k;  // .8 and more by texels alone
    }
}

// Also of suns on the seam and about a pole, in the parts of texels.
TEST(Environment, densities_are_those_of_samples_within_bright_texels) {
    const SobolPoints points(2);
    for (const Vec3f& at : {Vec3f(-1.0f, 1e-4f, 0.1f), Vec3f(0.001f, 0.0f, 1.0f),
                            Vec3f(0.0f, 0.001f, -1.0f), Vec3f(0.3f, -0.5f, 0.6f)}) {
        const Vec3f sun = glm::normalize(at);
        const Environment world(world_of([&](const Vec3f& d) {
                                    return Vec3f(glm::distance(d, sun) < 0.0046f ? 1e5f : 0.3f);
                                }),
                                kProgress);
        int equal = 0;
        for (std::uint32_t i = 0; i < 1024; ++i) {
            const Environment::Sample sample = world.sample(points(i));
            equal += std::abs(world.at(sample.direction).pdf / sample.pdf - 1.0f) < 2e-2f;
        }
        EXPECT_GE(equal, 1010) << at.x << ' ' << at.y << ' ' << at.z;  // borders of parts
    }
}

// What is known of texels is the world's own mean over them, for each kind of lobe.
TEST(Environment, texels_of_a_filtered_world_have_its_irradiance) {
    WorldEvaluator world{
        [](const std::vector<Vec3f>& directions, float, RayType ray, std::vector<Vec3f>& out) {
            out.clear();
            for (const Vec3f& d : directions)
                out.push_back(ray == RayType::Diffuse ? Vec3f(1.0f + d.z, 2.0f, 0.0f)
                                                      : Vec3f(0.0f, 0.0f, 3.0f + d.x));
        }};
    EXPECT_FALSE(Environment(world, kProgress, 64).has_radiance());
    world.is_filtered = world.is_image = world.by_lobe = true;
    const Environment environment(world, kProgress, 64);
    ASSERT_TRUE(environment.has_radiance());
    const SobolPoints points(3);
    const std::uint32_t count = 1 << 14;
    Vec3d diffuse(0.0), glossy(0.0);
    for (std::uint32_t i = 0; i < count; ++i) {
        const Environment::Sample from = environment.sample(points(i));
        const double weight = std::max(0.0f, from.direction.z) / from.pdf / count;
        diffuse += weight * Vec3d(environment.texel_radiance(from.texel, RayType::Diffuse));
        glossy += weight * Vec3d(environment.texel_radiance(from.texel, RayType::Glossy));
    }
    EXPECT_NEAR(diffuse.x, kPi * (1.0 + 2.0 / 3.0), 0.01 * diffuse.x);
    EXPECT_NEAR(diffuse.y, kPi * 2.0, 0.01 * diffuse.y);
    EXPECT_NEAR(glossy.z, kPi * 3.0, 0.01 * glossy.z);
    EXPECT_EQ(diffuse.z + glossy.x + glossy.y, 0.0);
}

TEST(Environment, directions_that_are_not_finite_count_as_black) {
    WorldEvaluator broken = world_of([](const Vec3f& v) {
        return Vec3f(v.z > 0 ? std::numeric_limits<float>::quiet_NaN() : 1.0f);
    });
    broken.is_filtered = true;  // a direction a texel
    const Environment world(broken, kProgress, 32);
    EXPECT_EQ(world.broken(), 32u * 32u);
    const SobolPoints points(4);
    for (std::uint32_t i = 0; i < 256; ++i) {
        const Environment::Sample sample = world.sample(points(i));
        EXPECT_LT(sample.direction.z, 0.15f);  // one texel blurs across the horizon
        EXPECT_TRUE(std::isfinite(sample.pdf));
    }
}

TEST(Environment, stops_when_cancelled) {
    Progress progress;
    progress.cancel();
    EXPECT_THROW(Environment(sunny(), progress, 64), Cancelled);
}

}  // namespace
}  // namespace granita
