// SPDX-License-Identifier: GPL-3.0-or-later
// Light that changes within the shutter, against closed forms of its mean over time.
#include <gtest/gtest.h>

#include "math/sampling.h"
#include "shade/lights/direct_light.h"
#include "shade/lights/light_scene.h"
#include "shade/shading_points.h"

namespace granita {
namespace {

GeometryData square(float half) {
    return quads("mesh 'Square'",
                 {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}});
}

/// A flat grid that faces +z, one vertex in the middle at `knots[k]` plus one unit around it.
Grid moving_grid(const std::vector<Vec3f>& knots) {
    Grid grid;
    grid.n_u = grid.n_v = 2;
    grid.knots = static_cast<int>(knots.size());
    for (const Vec3f& center : knots)
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) grid.positions.push_back(center + Vec3f(i, j, 0));
    return grid;
}
constexpr std::size_t kMiddle = 4;

class LightMotionTest : public testing::Test {
  protected:
    LightMotionTest() { scene.options.light_samples = 1024; }

    Vec3f reflect(const ShadingPoints& points, const Lobe& lobe, std::size_t index = 0,
                  const PointPaths& paths = {}) {
        const DirectLight light(scene, world, statistics, report, progress);
        return light.reflect(points, closure_of(lobe), {900, 0, 1}, nullptr, paths)[index];
    }
    float lit(float x) {
        const ShadingPoints points = points_facing_up({{x, 0, 0}});
        return reflect(points, lambert(points, 1.0f)).x;
    }
    Instance& add_mover(float half, std::vector<Mat4d> knots) {
        Instance& mover = scene.instances[add_instance(scene, square(half), knots[0])];
        mover.world_from_object = std::move(knots);
        return mover;
    }

    Scene scene = empty_scene();
    WorldEvaluator world = constant_world(Vec3f(0.0f));
    Statistics statistics;
    Report report;
    Progress progress;
};

/// Share of t in [0, 1] in which a square of half width 1 whose middle goes from -2 to 2 covers x.
float covered(float x) {
    return std::max(0.0f, std::min(2.0f, x + 1) - std::max(-2.0f, x - 1)) / 4.0f;
}

// 1024 net points in time: an edge in a stratum is off by less than 1 / 1024, two edges by 2.
constexpr float kNet = 2.0f / 1024;

TEST_F(LightMotionTest, a_moving_squares_shadow_under_a_sun_is_a_ramp) {
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    add_mover(1.0f, {at({-2, 0, 1}), at({2, 0, 1})});
    for (const float x : {-3.5f, -2.6f, -1.7f, -0.4f, 0.0f, 0.9f, 2.3f, 2.9f, 3.2f})
        EXPECT_NEAR(lit(x), 1.0f - covered(x), kNet) << x;
}

TEST_F(LightMotionTest, a_bend_in_the_way_is_a_bend_in_the_shadow) {
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    // There and back again: every place is covered twice as fast and twice.
    add_mover(1.0f, {at({-2, 0, 1}), at({2, 0, 1}), at({-2, 0, 1})});
    EXPECT_NEAR(lit(0.5f), 1.0f - covered(0.5f), 2 * kNet);
    EXPECT_NEAR(lit(-2.5f), 1.0f - covered(-2.5f), 2 * kNet);
}

TEST_F(LightMotionTest, the_shutters_curve_weighs_the_times) {
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    scene.options.shutter_curve = {0.0f, 2.0f};
    // Until t = 1/2 the square covers x = -1, a quarter of the opening.
    add_mover(1.0f, {at({-2, 0, 1}), at({2, 0, 1})});
    EXPECT_NEAR(lit(-1.0f), 0.75f, kNet);
}

TEST_F(LightMotionTest, deformation_blurs_shadows) {
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    GeometryData data = square(1.0f);
    const std::vector<Vec3f> rest = data.points;
    data.points.clear();
    data.knots = 2;
    for (const float x : {-2.0f, 2.0f})
        for (const Vec3f& p : rest) data.points.push_back(p + Vec3f(x, 0, 0));
    add_instance(scene, data, at({0, 0, 1}));
    for (const float x : {-2.6f, 0.0f, 2.3f}) EXPECT_NEAR(lit(x), 1.0f - covered(x), kNet) << x;
}

TEST_F(LightMotionTest, soft_light_and_the_world_see_the_mean_too) {
    // A mover that is away for half of the shutter takes half of what it takes where it rests.
    const std::vector<Mat4d> jump = {at({0, 0, 1}), at({0, 0, 1}), at({1e5, 0, 1}),
                                     at({1e5, 0, 1})};
    for (const bool area : {true, false}) {
        scene = empty_scene();
        scene.options.light_samples = 4096;
        world = constant_world(Vec3f(area ? 0.0f : 1.0f));
        Light light = light_of(LightKind::Area, 100.0f, aimed({0, 0, 3}, {0, 0, -1}));
        light.size = {2.0f, 2.0f};
        if (area) scene.lights = {light};
        const float open = lit(0.0f);
        add_mover(0.4f, {at({0, 0, 1})});
        const float shaded = lit(0.0f);
        EXPECT_LT(shaded, 0.9f * open);
        // Of the three segments the first hides, the last does not; in the second it is gone
        // within 1e-5 of it.
        scene.instances[0].world_from_object = jump;
        EXPECT_NEAR(lit(0.0f), (shaded + 2 * open) / 3, 0.004f * open) << area;
    }
}

TEST_F(LightMotionTest, a_receiver_goes_with_its_shade) {
    // Point and square move together: always covered.  A grid at rest is covered a quarter of it.
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    add_mover(1.0f, {at({-4, 0, 1}), at({4, 0, 1})});
    Instance& floor = add_mover(3.0f, {at({-4, 0, 0}), at({4, 0, 0})});
    floor.casts_shadow = false;
    Grid grid = moving_grid({{-4, 0, 0}, {4, 0, 0}});
    grid.instance = 1;
    const ShadingPoints points = points_facing_up(
        std::vector<Vec3f>(grid.positions.begin(), grid.positions.begin() + grid.vertex_count()));
    const PointPaths paths(grid, scene, points);
    ASSERT_TRUE(paths.moves());
    EXPECT_EQ(paths.at(kMiddle, 0.75f).p, Vec3f(2, 0, 0));
    EXPECT_EQ(paths.at(kMiddle, 0.75f).normal, Vec3f(0, 0, 1));
    EXPECT_EQ(reflect(points, lambert(points, 1.0f), kMiddle, paths).x, 0.0f);
    EXPECT_NEAR(lit(0.0f), 0.75f, kNet);
}

TEST_F(LightMotionTest, the_cameras_motion_alone_moves_nothing) {
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    scene.camera.world_from_camera = {at({-1, 0, 5}), at({1, 0, 5})};
    add_mover(1.0f, {at({0, 0, 1})});
    Grid grid = moving_grid({{1, 0, -5}, {-1, 0, -5}});
    const ShadingPoints points = points_facing_up(std::vector<Vec3f>(9, Vec3f(0, 0, -5)));
    EXPECT_FALSE(PointPaths(grid, scene, points).moves());
    const DirectLight light(scene, world, statistics, report, progress);
    EXPECT_FALSE(light.varies());
    // A receiver that moves in the world is where it is in the world, whatever the camera does.
    scene.instances[0].world_from_object = {at({0, 0, 0}), at({2, 0, 0})};
    grid = moving_grid({{1, 0, -5}, {1, 0, -5}});
    const PointPaths paths(grid, scene, points);
    EXPECT_EQ(paths.at(kMiddle, 0.0f).p, Vec3f(0, 0, -5));
    EXPECT_EQ(paths.at(kMiddle, 1.0f).p, Vec3f(2, 0, -5));
    // What goes with the camera has one knot before it, but moves.
    const PointPaths carried(moving_grid({{0, 0, -5}}), scene, points);
    EXPECT_EQ(carried.at(kMiddle, 1.0f).p - carried.at(kMiddle, 0.0f).p, Vec3f(2, 0, 0));
}

TEST_F(LightMotionTest, only_points_near_the_way_of_a_caster_take_more_rays) {
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    add_mover(1.0f, {at({-2, 0, 1}), at({2, 0, 1})});
    lit(10.0f);
    EXPECT_EQ(statistics.get(Counter::RaysShadow), 1u);
    lit(0.0f);
    EXPECT_EQ(statistics.get(Counter::RaysShadow), 1u + 1024u);
}

TEST_F(LightMotionTest, a_surface_that_turns_away_does_not_shade_itself) {
    // A double-sided square that turns upside down by its deformation, seen at the frame time from
    // above: light of the frame time's side stays.
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    scene.options.frame_time = 0.0f;
    GeometryData data = square(1.0f);
    const std::vector<Vec3f> rest = data.points;
    data.knots = 2;
    for (const Vec3f& p : rest) data.points.emplace_back(-p.x, p.y, p.z);
    add_instance(scene, data, at({0, 0, 0}));
    Grid grid;
    grid.n_u = grid.n_v = 2;
    grid.knots = 2;
    for (const float side : {1.0f, -1.0f})
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) grid.positions.emplace_back(side * 0.5f * i, 0.5f * j, 0);
    const ShadingPoints points =
        points_facing_up(std::vector<Vec3f>(grid.positions.begin(), grid.positions.begin() + 9));
    const PointPaths paths(grid, scene, points);
    EXPECT_EQ(paths.at(kMiddle, 1.0f).normal, Vec3f(0, 0, -1));
    const DirectLight light(scene, world, statistics, report, progress);
    const GridKey key{scene.instances[0].key, 0, 1};
    const auto radiance =
        light.reflect(points, closure_of(lambert(points, 1.0f)), key, nullptr, paths);
    EXPECT_NEAR(radiance[kMiddle].x, 1.0f, 1e-4f);
}

TEST_F(LightMotionTest, a_moving_lamp_and_a_changing_strength_light_with_their_mean) {
    // Straight up from distance 1 to 3: the mean of 1 / d^2 is 1 / 3.
    Light light = light_of(LightKind::Point, 4 * kPi * kPi, at({0, 0, 1}));
    light.world_from_light.push_back(at({0, 0, 3}));
    scene.lights = {light};
    // 256 places instead of a continuous way: the midpoint rule's own error is below 1e-5.
    EXPECT_NEAR(lit(0.0f), 1.0f / 3.0f, 1e-3f);
    light = light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}));
    light.energy_knots = {0.0f, kPi, 0.0f};
    scene.lights = {light};
    EXPECT_NEAR(lit(0.0f), 0.5f, 1e-3f);
    scene.lights[0].energy = 0.0f;  // at the frame time it is dark
    EXPECT_NEAR(lit(0.0f), 0.5f, 1e-3f);
}

TEST_F(LightMotionTest, a_lamp_that_comes_or_goes_shines_for_its_part_of_the_shutter) {
    // Hard, soft, and in a mirror; of two that take turns every time sees exactly one.
    const Light kinds[] = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1})),
                           light_of(LightKind::Area, 100.0f, aimed({0, 0, 3}, {0, 0, -1}))};
    for (const Light& light : kinds) {
        const ShadingPoints points = points_facing_up({{0.5f, 0, 0}});
        const auto seen = [&](const std::vector<Lifespan>& lives) {
            scene.lights.assign(lives.size(), light);
            for (std::size_t i = 0; i < lives.size(); ++i) scene.lights[i].lifespan = lives[i];
            return Vec2f(lit(0.5f), reflect(points, glossy(points, 0.0f)).x);
        };
        const Vec2f whole = seen({{}});
        for (const float end : {0.25f, 0.3f}) {
            const Vec2f before = seen({{0.0f, end}}), after = seen({{end}});
            for (int i = 0; i < 2; ++i) {
                EXPECT_NEAR(before[i], end * whole[i], kNet * whole[i] + 1e-6f);
                EXPECT_NEAR(before[i] + after[i], whole[i], 1e-5f * whole[i]);
            }
        }
        EXPECT_EQ(seen({{2.0f, 3.0f}}), Vec2f(0.0f));
    }
}

TEST_F(LightMotionTest, one_light_sample_has_a_time_of_its_own) {
    // 4,096 points in one place: four standard deviations of as many draws of 0 and 1, and a half.
    constexpr float kDraws = 4.0f * 0.5f / 64.0f;
    scene.options.light_samples = 1;
    const ShadingPoints points = points_facing_up(std::vector<Vec3f>(4096, Vec3f(0.5f, 0, 0)));
    const auto mean = [&] {
        const DirectLight light(scene, world, statistics, report, progress);
        float sum = 0.0f;
        for (const Vec3f& value :
             light.reflect(points, closure_of(lambert(points, 1.0f)), {900, 0, 1}, nullptr, {}))
            sum += value.x / 4096.0f;
        return sum;
    };
    scene.lights = {light_of(LightKind::Sun, kPi, aimed({0, 0, 9}, {0, 0, -1}))};
    scene.lights[0].lifespan = {0.625f, 1.0f};  // not at the frame time
    EXPECT_NEAR(mean(), 0.375f, kDraws);
    scene.lights[0].lifespan = {};
    add_mover(1.0f, {at({-2, 0, 1}), at({2, 0, 1})});
    EXPECT_NEAR(mean(), 1.0f - covered(0.5f), kDraws);
}

TEST_F(LightMotionTest, mirrors_show_a_lamp_behind_what_moves) {
    Light light = light_of(LightKind::Area, 100.0f, aimed({0, 0, 3}, {0, 0, -1}));
    scene.lights = {light};
    const ShadingPoints points = points_facing_up({{0.5f, 0, 0}});
    const float open = reflect(points, glossy(points, 0.0f)).x;
    add_mover(1.0f, {at({-2, 0, 1}), at({2, 0, 1})});
    EXPECT_NEAR(reflect(points, glossy(points, 0.0f)).x, open * (1 - covered(0.5f)), kNet * open);
}

}  // namespace
}  // namespace granita
