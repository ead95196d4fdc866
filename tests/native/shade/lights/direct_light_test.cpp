// SPDX-License-Identifier: GPL-3.0-or-later
// Whole lighting of small scenes against closed forms.
#include "shade/lights/direct_light.h"

#include <gtest/gtest.h>

#include "math/sampling.h"
#include "shade/lights/light_scene.h"

namespace granita {
namespace {

class DirectLightTest : public testing::Test {
  protected:
    std::vector<Vec3f> reflect(const ShadingPoints& points, const Lobe& lobe,
                               const GridKey& key = {900, 0, 1}) {
        const DirectLight light(scene, world, statistics, report, progress, opacity);
        return light.reflect(points, closure_of(lobe), key);
    }

    Scene scene = empty_scene();
    WorldEvaluator world = constant_world(Vec3f(0.0f));
    RayMaterials opacity;
    Statistics statistics;
    Report report;
    Progress progress;
};

GeometryData box_square(float half, const std::string& name = "mesh 'Square'") {
    return quads(name, {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}});
}

TEST_F(DirectLightTest, lambert_under_a_point_light) {
    scene.lights = {light_of(LightKind::Point, 100.0f, at({0, 0, 3}))};
    const ShadingPoints points = points_facing_up({{0, 0, 0}, {3, 0, 0}});
    const auto radiance = reflect(points, lambert(points, 0.5f));
    EXPECT_NEAR(radiance[0].x, 0.5 / kPi * 100.0 / (4 * kPi * 9), 1e-6);
    EXPECT_NEAR(radiance[1].x, 0.5 / kPi * 100.0 / (4 * kPi * 18) / std::sqrt(2.0), 1e-6);
    EXPECT_EQ(statistics.get(Counter::RaysShadow), 0u);  // nothing there to cast a shadow
}

TEST_F(DirectLightTest, a_shadow_ray_a_hard_light_and_one_a_sample_of_a_soft_one) {
    scene.lights = {light_of(LightKind::Point, 100.0f, at({0, 0, 3}))};
    add_instance(scene, box_square(0.1f), at({50, 0, 1}));
    const ShadingPoints points = points_facing_up({{0, 0, 0}, {3, 0, 0}});
    reflect(points, lambert(points, 0.5f));
    EXPECT_EQ(statistics.get(Counter::RaysShadow), 2u);
    EXPECT_GT(statistics.peak_ray_bytes(), 0u);
    scene.lights[0].radius = 0.1f;
    scene.options.light_samples = 16;
    reflect(points, lambert(points, 0.5f));
    EXPECT_EQ(statistics.get(Counter::RaysShadow), 2u + 32u);
    scene.lights[0].casts_shadow = false;
    reflect(points, lambert(points, 0.5f));
    EXPECT_EQ(statistics.get(Counter::RaysShadow), 34u);
}

// The mean over a square of points, which is what a pixel or a lens shows of them, is far nearer
// than that of as many points with samples of their own would be: its error then is a point's over
// the root of their number.
TEST_F(DirectLightTest, neighbours_are_stratified_together) {
    scene.lights = {light_of(LightKind::Area, 100.0f, aimed({0, 0, 1}, {0, 0, -1}))};
    scene.options.light_samples = 4;
    constexpr std::size_t kSide = 8, kCount = kSide * kSide;
    ShadingPoints points = points_facing_up(std::vector<Vec3f>(kCount, Vec3f(0.0f)));
    points.columns = kSide;
    // A square of half side a, at distance 1 over the point.
    const double a = 0.5, side = a / std::sqrt(1 + a * a);
    const double irradiance = 100.0 / kPi * 4.0 * side * std::atan(side);
    double point_error = 0.0, mean_error = 0.0;
    constexpr std::uint32_t kGrids = 50;
    for (std::uint32_t grid = 0; grid < kGrids; ++grid) {
        double sum = 0.0;
        for (const Vec3f& radiance : reflect(points, lambert(points, 1.0f), {900, grid, 1})) {
            const double error = radiance.x * kPi / irradiance - 1.0;
            point_error += error * error / (kCount * kGrids);
            sum += error / kCount;
        }
        mean_error += sum * sum / kGrids;
    }
    EXPECT_LT(std::sqrt(mean_error), 0.25 * std::sqrt(point_error / kCount));
}

// What is mixed by a mask or by Fresnel has other lobes, and other numbers of samples of them, at
// each point; a pixel's mean is as clean all the same.
TEST_F(DirectLightTest, neighbours_with_other_lobes_are_stratified_together) {
    scene.lights = {light_of(LightKind::Area, 100.0f, aimed({0, 0, 1}, {0, 0, -1}))};
    scene.options.light_samples = 4;
    constexpr std::size_t kSide = 8, kCount = kSide * kSide;
    ShadingPoints points = points_facing_up(std::vector<Vec3f>(kCount, Vec3f(0.0f)));
    points.columns = kSide;
    const double a = 0.5, side = a / std::sqrt(1 + a * a);
    const double irradiance = 100.0 / kPi * 4.0 * side * std::atan(side);
    // It adds nothing to speak of: the mean is that of the other.
    Lobe mask = lambert(points, 1.0f);
    const SobolPoints random(11);
    for (std::uint32_t i = 0; i < kCount; ++i)
        mask.weight[i] = Vec3f(random(i).x < 0.5f ? 0.0f : 1e-6f);
    SurfaceClosure closure;
    closure.lobes = {mask, lambert(points, 1.0f)};
    double point_error = 0.0, mean_error = 0.0;
    constexpr std::uint32_t kGrids = 50;
    const DirectLight light(scene, world, statistics, report, progress);
    for (std::uint32_t grid = 0; grid < kGrids; ++grid) {
        double sum = 0.0;
        for (const Vec3f& radiance : light.reflect(points, closure, {900, grid, 1})) {
            const double error = radiance.x * kPi / irradiance - 1.0;
            point_error += error * error / (kCount * kGrids);
            sum += error / kCount;
        }
        mean_error += sum * sum / kGrids;
    }
    // As for points that are alike, above.
    EXPECT_LT(std::sqrt(mean_error), 0.25 * std::sqrt(point_error / kCount));
}

TEST_F(DirectLightTest, runs_of_samples_adjoin_where_points_take_different_numbers) {
    // A white cap above two diffuse lobes whose shares go from none to all.
    world = world_of([](const Vec3f& d) { return Vec3f(d.z > 0.5f ? 1.0f : 0.0f); });
    world.is_constant = false;
    scene.options.light_samples = 8;
    constexpr std::size_t kSide = 8, kCount = kSide * kSide;
    ShadingPoints points = points_facing_up(std::vector<Vec3f>(kCount, Vec3f(0.0f)));
    points.columns = kSide;
    const SobolPoints random(12);
    Lobe first = lambert(points, 1.0f), second = first;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const float share = random(i).x;
        first.weight[i] = Vec3f(share);
        second.weight[i] = Vec3f(1.0f - share);
    }
    SurfaceClosure mixed;
    mixed.lobes = {first, second};
    const DirectLight light(scene, world, statistics, report, progress);
    double squared = 0.0, alike = 0.0;
    constexpr std::uint32_t kGrids = 100;
    for (std::uint32_t grid = 0; grid < kGrids; ++grid) {
        const auto mean_error = [&](const SurfaceClosure& closure) {
            double sum = 0.0;
            for (const Vec3f& radiance : light.reflect(points, closure, {900, grid, 1}))
                sum += radiance.x / kCount;
            return sum - 0.75;  // the cap's projected part of the hemisphere
        };
        squared += std::pow(mean_error(mixed), 2) / kGrids;
        alike += std::pow(mean_error(closure_of(lambert(points, 1.0f))), 2) / kGrids;
    }
    // Two sequences that are each stratified, of half as many samples, err by the root of two more.
    EXPECT_LT(std::sqrt(squared), 2.0 * std::sqrt(alike));
}

TEST_F(DirectLightTest, lobes_see_the_world_that_is_theirs) {
    // Diffuse rays see 1, glossy ones 2, mirrors 4; constant and not.
    for (const bool constant : {true, false}) {
        world = {
            [](const std::vector<Vec3f>& directions, float, RayType ray, std::vector<Vec3f>& out) {
                out.assign(directions.size(), Vec3f(ray == RayType::Diffuse    ? 1.0f
                                                    : ray == RayType::Glossy   ? 2.0f
                                                    : ray == RayType::Singular ? 4.0f
                                                                               : 100.0f));
            },
            constant, true};
        scene.options.light_samples = 256;
        const ShadingPoints points = points_facing_up({{0, 0, 0}});
        // GGX of roughness .1 loses 1e-4 of its energy, a net of 256 points finds the rest to 1 %.
        EXPECT_NEAR(reflect(points, lambert(points, 0.5f))[0].x, 0.5f, 0.005f);
        EXPECT_NEAR(reflect(points, glossy(points, 0.1f))[0].x, 2.0f, 0.02f);
        EXPECT_NEAR(reflect(points, glossy(points, 0.0f))[0].x, 4.0f, 1e-5f);
    }
}

TEST_F(DirectLightTest, nothing_is_built_for_a_scene_without_light) {
    add_instance(scene, box_square(1), at({0, 0, 1}));
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    EXPECT_EQ(reflect(points, lambert(points, 0.5f))[0], Vec3f(0.0f));
    EXPECT_EQ(statistics.peak_ray_bytes(), 0u);
}

TEST_F(DirectLightTest, lights_obey_factors_and_visibility_by_lobe) {
    Light light = light_of(LightKind::Area, 100.0f, aimed({0, 0, 3}, {0, 0, -1}));
    scene.lights = {light};
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    const Lobe diffuse = lambert(points, 1.0f), shiny = glossy(points, 0.4f);
    const float full = reflect(points, diffuse)[0].x, full_shiny = reflect(points, shiny)[0].x;
    EXPECT_GT(full_shiny, 0.1f);
    scene.lights[0].diffuse_factor = 0.25f;
    EXPECT_NEAR(reflect(points, diffuse)[0].x, 0.25f * full, 1e-5f * full);
    EXPECT_EQ(reflect(points, shiny)[0].x, full_shiny);
    scene.lights[0].visible_glossy = false;
    EXPECT_EQ(reflect(points, shiny)[0].x, 0.0f);
    scene.lights[0].visible_diffuse = false;
    EXPECT_EQ(reflect(points, diffuse)[0].x, 0.0f);
}

TEST_F(DirectLightTest, an_unoccluded_constant_world_needs_no_luck) {
    world = constant_world({1.0f, 0.5f, 0.25f});
    scene.options.light_samples = 1;
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    const Vec3f radiance = reflect(points, lambert(points, 0.5f))[0];
    EXPECT_NEAR(radiance.x, 0.5f, 1e-6f);
    EXPECT_NEAR(radiance.y, 0.25f, 1e-6f);
    scene.world.lights_scene = false;
    EXPECT_EQ(reflect(points, lambert(points, 0.5f))[0], Vec3f(0.0f));
}

TEST_F(DirectLightTest, a_wall_hides_its_share_of_the_world) {
    // Wall of height h at distance a, very wide: it takes (1 - cos phi) / 2, tan phi = h / a
    // (Nusselt's analog).  4096 net points; the wall's ends hide 1e-4 less than infinity.
    const float a = 1.0f, h = 2.0f, wide = 1e4f;
    add_instance(scene,
                 quads("mesh 'Wall'", {{a, -wide, 0}, {a, wide, 0}, {a, wide, h}, {a, -wide, h}}),
                 Mat4d(1.0));
    world = constant_world(Vec3f(1.0f));
    scene.options.light_samples = 4096;
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    const double expected = 1.0 - 0.5 * (1.0 - 1.0 / std::sqrt(1.0 + h * h));
    EXPECT_NEAR(reflect(points, lambert(points, 1.0f))[0].x, expected, 2e-3);
    EXPECT_EQ(statistics.get(Counter::RaysOcclusion), 4096u);
}

TEST_F(DirectLightTest, soft_shadows_are_unbiased_at_any_sample_count) {
    // A square lamp half hidden by a half-plane: straight below its middle exactly half is seen, at
    // a slant the mean over independent grids must meet the closed form of the unhidden part:
    // corner form factors B-4 of Howell's catalog.  600 seeds of 4 samples; the bound is 4 standard
    // errors, so that a right program fails once in 16,000 changes of its seeds.
    Light light = light_of(LightKind::Area, 100.0f, aimed({0, 0, 2}, {0, 0, -1}));
    light.size = {2.0f, 2.0f};
    scene.lights = {light};
    scene.options.light_samples = 4;
    const float wide = 1e3f;
    add_instance(
        scene,
        quads("mesh 'Shade'", {{0, -wide, 1}, {wide, -wide, 1}, {wide, wide, 1}, {0, wide, 1}}),
        Mat4d(1.0));
    const auto corner = [](double x, double y) {
        const double rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
        return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * kPi);
    };
    // Below (0, 0, 0) the lamp is seen for x < 0: half of [-1, 1]^2 at height 2.
    const double expected = 100.0 / 4.0 * 2 * corner(0.5, 0.5) / kPi;
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    const DirectLight lighting(scene, world, statistics, report, progress);
    double sum = 0.0, squares = 0.0;
    const int seeds = 600;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
        const double x =
            lighting.reflect(points, closure_of(lambert(points, 1.0f)), {7, seed, 1})[0].x;
        sum += x;
        squares += x * x;
    }
    const double mean = sum / seeds;
    const double error = std::sqrt((squares / seeds - mean * mean) / (seeds - 1.0));
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, 0.02 * expected);
    EXPECT_NEAR(mean, expected, 4 * error);
}

TEST_F(DirectLightTest, sharp_and_rough_glossy_lobes_see_an_area_light_alike_in_the_mean) {
    // A mirror above a lamp that fills the mirrored direction returns its radiance; an ever sharper
    // lobe must tend to the same value, from both ways of sampling.
    Light light = light_of(LightKind::Area, 100.0f, aimed({0, 0, 2}, {0, 0, -1}));
    light.size = {1.0f, 1.0f};
    scene.lights = {light};
    scene.options.light_samples = 64;
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    const double radiance = 100.0 / kPi;
    EXPECT_NEAR(reflect(points, glossy(points, 0.0f))[0].x, radiance, 1e-4);
    EXPECT_NEAR(reflect(points, glossy(points, 0.05f))[0].x, radiance, 0.01 * radiance);
    // Half of the lobe's light misses a lamp whose edge is straight above.
    scene.lights[0].world_from_light[0][3].x = 0.5;
    EXPECT_NEAR(reflect(points, glossy(points, 0.05f))[0].x, 0.5 * radiance, 0.03 * radiance);
}

TEST_F(DirectLightTest, a_world_image_with_a_small_sun_is_clean_on_every_lobe) {
    const Vec3f sun = glm::normalize(Vec3f(0.0f, 0.4f, 1.0f));
    const float cos_sun = std::cos(0.02f);
    world = world_of(
        [=](const Vec3f& d) { return Vec3f(glm::dot(d, sun) > cos_sun ? 5000.0f : 0.5f); });
    // Three in four samples find the sun, a binomial of standard error 1 % at 4096.
    scene.options.light_samples = 4096;
    const ShadingPoints points = points_facing_up({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
    // Lambert: sky, and the cap's pi sin^2(a) cos(tilt) / pi.
    const double s2 = 1.0 - static_cast<double>(cos_sun) * cos_sun;
    const double expected = 0.5 + (5000.0 - 0.5) * s2 * sun.z;
    for (const Vec3f& c : reflect(points, lambert(points, 1.0f)))
        EXPECT_NEAR(c.x, expected, 0.02 * expected);
    // A mirror at the sun sees it, elsewhere the sky.
    ShadingPoints slanted = points;
    slanted.view[0] = glm::normalize(Vec3f(0.0f, -0.4f, 1.0f));
    const auto mirrored = reflect(slanted, glossy(slanted, 0.0f));
    EXPECT_EQ(mirrored[0].x, 5000.0f);
    EXPECT_EQ(mirrored[1].x, 0.5f);
}

TEST_F(DirectLightTest, the_same_grid_gets_the_same_bits_and_others_get_other_samples) {
    Light light = light_of(LightKind::Point, 100.0f, at({0, 0, 2}));
    light.radius = 1.0f;
    scene.lights = {light};
    add_instance(scene, box_square(0.5f), at({0.4, 0, 1}));
    const ShadingPoints points = points_facing_up({{0, 0, 0}, {0.3f, 0, 0}, {0.6f, 0, 0}});
    const Lobe lobe = lambert(points, 1.0f);
    const auto first = reflect(points, lobe, {5, 1, 2});
    EXPECT_EQ(first, reflect(points, lobe, {5, 1, 2}));
    EXPECT_NE(first, reflect(points, lobe, {5, 1, 3}));
}

TEST_F(DirectLightTest, a_grid_stops_being_lit_when_cancelled) {
    scene.lights = {light_of(LightKind::Point, 100.0f, at({0, 0, 3}))};
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    const DirectLight light(scene, world, statistics, report, progress);
    progress.cancel();
    EXPECT_THROW(light.reflect(points, closure_of(lambert(points, 1.0f)), {}), Cancelled);
}

TEST_F(DirectLightTest, a_world_that_is_not_finite_is_reported) {
    world = world_of([](const Vec3f&) { return Vec3f(std::nanf("")); });
    scene.world.name = "Sky";
    const ShadingPoints points = points_facing_up({{0, 0, 0}});
    EXPECT_EQ(reflect(points, lambert(points, 1.0f))[0], Vec3f(0.0f));
    ASSERT_EQ(report.warnings().size(), 1u);
    EXPECT_EQ(report.warnings()[0].datablock, "world 'Sky'");
}

}  // namespace
}  // namespace granita
