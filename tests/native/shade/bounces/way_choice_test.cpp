// SPDX-License-Identifier: GPL-3.0-or-later
// Which ways are followed, against the means that chance must keep: 100,000 points each, so that a
// part p of them is told within sqrt(p / 100,000); five times that is never met by chance.
#include "shade/bounces/way_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/luminance.h"

namespace granita {
namespace {

constexpr std::uint32_t kPoints = 100000;

LobeRay way(std::uint32_t point, RayType type, float weight) {
    LobeRay ray;
    ray.ray.type = type;
    ray.weight = Vec3f(weight, 0.5f * weight, 0.25f * weight);
    ray.point = ray.place = point;
    ray.share = 0.5f;
    return ray;
}

double sum_of(const std::vector<LobeRay>& ways, RayType type) {
    double sum = 0.0;
    for (const LobeRay& one : ways)
        if (one.ray.type == type) sum += one.weight.y;
    return sum;
}

TEST(WayChoice, gloss_that_brings_little_is_thinned_out_and_its_mean_stays) {
    std::vector<LobeRay> ways;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        ways.push_back(way(i, RayType::Diffuse, 0.5f));
        ways.push_back(way(i, RayType::Glossy, 0.05f));
        ways.push_back(way(i, RayType::Transmission, 0.01f));
    }
    thin_out(ways, 1);
    const double expected = kPoints * (1.0 + 0.1 + 0.02);
    EXPECT_NEAR(static_cast<double>(ways.size()), expected, 5.0 * std::sqrt(0.12 * kPoints));
    EXPECT_DOUBLE_EQ(sum_of(ways, RayType::Diffuse), 0.25 * kPoints);
    EXPECT_NEAR(sum_of(ways, RayType::Glossy), 0.025 * kPoints,
                0.25 * 5.0 * std::sqrt(0.1 * kPoints));
    EXPECT_NEAR(sum_of(ways, RayType::Transmission), 0.005 * kPoints,
                0.25 * 5.0 * std::sqrt(0.02 * kPoints));
}

TEST(WayChoice, diffuse_ways_and_mirrors_and_what_is_alone_stay) {
    std::vector<LobeRay> ways;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        ways.push_back(way(2 * i, RayType::Glossy, 1.0f));
        ways.push_back(way(2 * i, RayType::Diffuse, 0.001f));
        ways.push_back(way(2 * i, RayType::Singular, 0.001f));
        ways.push_back(way(2 * i + 1, RayType::Glossy, 0.001f));
    }
    const std::vector<LobeRay> before = ways;
    thin_out(ways, 1);
    ASSERT_EQ(ways.size(), before.size());
    for (std::size_t i = 0; i < ways.size(); ++i) EXPECT_EQ(ways[i].weight, before[i].weight);
}

TEST(WayChoice, one_way_stands_for_all_from_a_place) {
    const BouncedPath path{.next = way(0, RayType::Diffuse, 1.0f)};
    const std::vector<LobeRay> ways{way(0, RayType::Diffuse, 0.6f), way(0, RayType::Glossy, 0.2f)};
    const Vec3f through(0.2f);
    std::vector<ChosenWay> chosen;
    double by[3] = {};
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        choose_ways(path, ways, through, (static_cast<float>(i) + 0.5f) / kPoints, chosen);
        ASSERT_EQ(chosen.size(), 1u);
        const std::size_t which = chosen[0].ray == nullptr ? 0 : chosen[0].ray == &ways[0] ? 1 : 2;
        by[which] += chosen[0].weight.x / kPoints;
    }
    // Every place of [0, 1) once: but for rounding there is no chance.
    EXPECT_NEAR(by[0], 0.2, 1e-4);
    EXPECT_NEAR(by[1], 0.6, 1e-4);
    EXPECT_NEAR(by[2], 0.2, 1e-4);
}

// A pane's two ways, of a point of 16 light samples and of one that counts as .3 of one.
TEST(WayChoice, panes_make_one_way_of_less_than_a_light_sample) {
    BouncedPath path{.next = way(0, RayType::Singular, 1.0f)};
    path.kind = BouncedPath::Kind::Mirrored;
    const std::vector<LobeRay> ways{way(0, RayType::Singular, 0.9f),
                                    way(0, RayType::Singular, 0.1f)};
    std::vector<ChosenWay> chosen;
    path.sure_part = 16.0f;
    choose_ways(path, ways, Vec3f(0.0f), 0.5f, chosen);
    ASSERT_EQ(chosen.size(), 2u);
    EXPECT_TRUE(chosen[0].is_sure && chosen[1].is_sure);
    EXPECT_NEAR(chosen[0].sure_part, 14.4, 1e-5);
    EXPECT_NEAR(chosen[1].sure_part, 1.6, 1e-5);

    path.sure_part = 0.3f;
    double by[2] = {};
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        choose_ways(path, ways, Vec3f(0.0f), (static_cast<float>(i) + 0.5f) / kPoints, chosen);
        ASSERT_EQ(chosen.size(), 1u);
        EXPECT_FALSE(chosen[0].is_sure);
        by[chosen[0].ray == &ways[0] ? 0 : 1] += chosen[0].weight.x / kPoints;
    }
    EXPECT_NEAR(by[0], 0.9, 1e-4);
    EXPECT_NEAR(by[1], 0.1, 1e-4);
}

TEST(WayChoice, mirrors_of_mirrors_are_in_no_doubt) {
    BouncedPath path{.next = way(0, RayType::Singular, 1.0f)};
    path.kind = BouncedPath::Kind::Mirrored;
    path.sure_part = 1.0f;
    const std::vector<LobeRay> ways{way(0, RayType::Singular, 0.9f),
                                    way(0, RayType::Diffuse, 0.01f)};
    std::vector<ChosenWay> chosen;
    choose_ways(path, ways, Vec3f(0.0f), 0.5f, chosen);
    ASSERT_EQ(chosen.size(), 2u);
    EXPECT_TRUE(chosen[0].is_sure);
    EXPECT_EQ(chosen[0].weight, ways[0].weight);
    EXPECT_EQ(chosen[0].goes_on, 1.0f);
    EXPECT_FALSE(chosen[1].is_sure);
    EXPECT_LT(chosen[1].goes_on, 0.2f);
}

}  // namespace
}  // namespace granita
