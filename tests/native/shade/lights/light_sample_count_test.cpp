// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_sample_count.h"

#include <gtest/gtest.h>

namespace granita {
namespace {

/// A raster of one unit a pixel.
Scene pixels(int samples = 1 << 20) {
    Scene scene;
    scene.camera.projection.perspective = false;
    scene.options.samples = samples;
    return scene;
}

/// A lattice of one micropolygon, a pixel wide, whose corners go from 0 by `motions[knot][corner]`.
Grid grid_with(const std::vector<std::array<Vec2f, 4>>& motions) {
    constexpr Vec2f kCorners[4] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    Grid grid;
    grid.n_u = grid.n_v = 1;
    grid.knots = static_cast<int>(motions.size());
    grid.motion = grid.knots > 1;
    for (const auto& motion : motions)
        for (std::size_t v = 0; v < 4; ++v)
            grid.positions.emplace_back(kCorners[v] + motion[v], 5.0f);
    return grid;
}

/// All corners at the same places.
Grid moved(const std::vector<Vec2f>& places) {
    std::vector<std::array<Vec2f, 4>> motions;
    for (const Vec2f& place : places) motions.push_back({place, place, place, place});
    return grid_with(motions);
}

/// Of the variance: the error of n stratified samples falls as 1 / n.
float share(const Grid& grid, const Scene& scene = pixels(), const std::vector<float>& curve = {}) {
    const float samples = light_sample_count(grid, scene, ShutterWarp(curve));
    return samples * samples;
}

/// 4 times the integral of the squared convolution of boxes of 4 and `length`, summed.
double integrated(double length) {
    constexpr int kSteps = 200000;
    const double wide = std::max(4.0, length), half = 0.5 * (4.0 + length),
                 step = 2 * half / kSteps;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double x = std::abs((i + 0.5) * step - half);
        const double overlap = std::min({4.0, length, half - x});
        sum += overlap * overlap / (4.0 * length * 4.0 * length) * step;
    }
    EXPECT_LE(sum * wide, 1.0 + 1e-6);
    return 4.0 * sum;
}

TEST(LightSampleCountTest, is_what_keeps_the_variance_of_the_mean_over_four_pixels) {
    for (const float length : {1.0f, 3.0f, 5.0f, 16.0f, 60.0f})
        EXPECT_NEAR(share(moved({{0, 0}, {0.6f * length, 0.8f * length}})), integrated(length),
                    1e-4)
            << length;
}

TEST(LightSampleCountTest, what_stands_still_has_all_of_it) {
    EXPECT_EQ(share(moved({{0, 0}})), 1.0f);
    EXPECT_EQ(share(moved({{0, 0}, {0, 0}})), 1.0f);
}

TEST(LightSampleCountTest, the_least_blurred_vertex_decides) {
    const std::array<Vec2f, 4> rest{}, turned{Vec2f(0), Vec2f(20, 0), Vec2f(20, 0), Vec2f(40, 0)};
    EXPECT_EQ(share(grid_with({rest, turned})), 1.0f);
}

TEST(LightSampleCountTest, blur_counts_while_light_arrives) {
    const std::vector<Vec2f> stop = {{0, 0}, {0, 0}, {0, 0}, {0, 0}, {40, 0}};
    EXPECT_EQ(share(moved(stop)), 1.0f);  // still for three quarters of the time
    const std::vector<Vec2f> way = {{0, 0}, {40, 0}};
    // Half of the light of an opening that falls to 0 arrives before 1 - sqrt(1/2), a quarter
    // before 1 - sqrt(3/4) and before 1/2 three.
    const double seen = 2.0 * 40.0 * (0.5 - (1.0 - std::sqrt(0.75)));
    EXPECT_NEAR(share(moved(way), pixels(), {1.0f, 0.0f}), integrated(seen), 1e-3);
    Grid brief = moved(way);
    brief.lifespan = {0.2f, 0.4f};
    EXPECT_EQ(share(brief), 1.0f);
}

TEST(LightSampleCountTest, a_point_that_stands_for_more_pixels_has_more_of_it) {
    Grid grid = moved({{0, 0}, {40, 0}});
    for (Vec3f& p : grid.positions) p.x = p.x < 20 ? 8 * p.x : 40 + 8 * (p.x - 40);
    // Eight square pixels and four points.
    EXPECT_NEAR(share(grid), 2.0 * integrated(40), 1e-4);
}

TEST(LightSampleCountTest, few_samples_see_few_points) {
    EXPECT_NEAR(share(moved({{0, 0}, {40, 0}}), pixels(16)), integrated(40) + 1.0 / 16, 1e-4);
}

TEST(LightSampleCountTest, a_row_of_a_rolling_shutter_sees_part_of_the_way) {
    Scene rolling = pixels();
    rolling.options.rolling_shutter = 0.25f;
    EXPECT_NEAR(share(moved({{0, 0}, {40, 0}}), rolling), integrated(10), 1e-4);
}

TEST(LightSampleCountTest, a_lens_blurs_both_ways) {
    Scene scene = pixels();
    Projection& lens = scene.camera.projection;
    lens.lens_radius = 12.0;
    lens.focus = 10.0;  // at 5 metres the circle is 12 pixels wide
    const double side = integrated(12.0 * std::sqrt(M_PI) / 2.0);
    EXPECT_NEAR(share(moved({{0, 0}}), scene), side * side, 1e-4);
    lens.focus = 5.0;
    EXPECT_EQ(share(moved({{0, 0}}), scene), 1.0f);
}

/// Two ribbons along u, this wide and 40 pixels long in all, and what lies between them.
Grid ribbons(float wide, int across) {
    Grid grid;
    grid.n_u = 5;
    grid.n_v = across;
    const float along[] = {0, 10, 20, 50, 60, 70};  // the third column ends the first ribbon
    for (int j = 0; j <= across; ++j)
        for (int i = 0; i <= 5; ++i) {
            const bool is_end = i == 2 || i == 3;
            const float v = wide * static_cast<float>(j) / static_cast<float>(across);
            grid.positions.emplace_back(along[i], is_end ? 0.0f : v, 5.0f);
        }
    return grid;
}

Scene of_kind(GeometryKind kind, int samples) {
    Scene scene = pixels(samples);
    GeometryData data;
    data.kind = kind;
    scene.geometries.push_back(std::move(data));
    scene.instances.emplace_back().geometry = 0;
    return scene;
}

TEST(LightSampleCountTest, ribbons_take_less_the_fewer_samples_and_the_narrower_they_are) {
    // Halves of the ribbons are triangles: the mean width is 3 / 4.
    const auto count = [](float wide, int samples, int across = 1,
                          GeometryKind kind = GeometryKind::Curves) {
        return edge_light_sample_count(ribbons(wide, across), of_kind(kind, samples));
    };
    EXPECT_FLOAT_EQ(count(1.0f, 16), edge_light_fraction(16));
    EXPECT_NEAR(edge_light_fraction(16), std::pow(16.0 / 650.0, 0.75), 1e-6);
    EXPECT_EQ(count(1.0f, 1024), 1.0f);
    EXPECT_NEAR(count(8.0f, 1), 0.75f * 0.75f, 0.1f);
    EXPECT_NEAR(count(8.0f, 1, 2), count(8.0f, 1), 0.02f);  // the ends slant
    EXPECT_EQ(count(100.0f, 16), 1.0f);
    EXPECT_EQ(count(1.0f, 16, 1, GeometryKind::Mesh), 1.0f);
}

TEST(LightSampleCountTest, steps_are_a_fourth_root_of_two_apart) {
    EXPECT_EQ(light_sample_step(1.0f), 1.0f);
    for (const float step : {1.0f, 0.84089642f, 0.70710678f, 0.5f, 0.037162722f})
        for (const float of : {1.08f, 1.0f, 0.93f})
            EXPECT_FLOAT_EQ(light_sample_step(of * step), step) << of;
    EXPECT_FLOAT_EQ(light_sample_step(0.9f), 0.84089642f);
}

}  // namespace
}  // namespace granita
