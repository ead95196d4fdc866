// SPDX-License-Identifier: GPL-3.0-or-later
// Irradiance of each kind of light against its closed form, in watts and metres.
#include "shade/lights/light_source.h"

#include <gtest/gtest.h>

#include <vector>

#include "math/sampling.h"
#include "shade/lights/light_scene.h"

namespace granita {
namespace {

std::unique_ptr<LightSource> source_of(const Light& light) {
    return make_light_source(light, light_frame(light, 0.5f, Vec3d(0.0)));
}

/// Irradiance on a surface element at `p` with normal `n`.  `count` points of a (0, m, 2)-net:
/// their error on these smooth integrands is far below the tolerances.
double irradiance(const LightSource& source, const Vec3f& p, const Vec3f& n,
                  std::uint32_t count = 4096) {
    const SobolPoints points(7);
    double sum = 0.0;
    if (source.is_hard()) count = 1;
    for (std::uint32_t i = 0; i < count; ++i) {
        LightSample sample;
        if (source.sample(p, points(i), sample))
            sum += std::max(0.0f, glm::dot(n, sample.direction)) * sample.radiance.x / sample.pdf;
    }
    return sum / count;
}

const Vec3f kUp(0, 0, 1);

TEST(PointLight, hard_one_obeys_the_inverse_square_law) {
    const auto source = source_of(light_of(LightKind::Point, 100.0f, at({0, 0, 3})));
    EXPECT_TRUE(source->is_hard());
    EXPECT_NEAR(irradiance(*source, Vec3f(0), kUp), 100.0 / (4 * kPi * 9), 1e-6);
    // Off axis at 45 degrees: twice the squared distance, cosine 1/sqrt 2.
    EXPECT_NEAR(irradiance(*source, Vec3f(3, 0, 0), kUp), 100.0 / (4 * kPi * 18) / std::sqrt(2.0),
                1e-6);
}

TEST(PointLight, soft_disc_on_its_axis) {
    Light light = light_of(LightKind::Point, 100.0f, at({0, 0, 2}));
    light.radius = 0.5f;
    const double radiance = 100.0 / (4 * kPi) / (kPi * 0.25);
    const double sin2 = 0.25 / (0.25 + 4.0);
    EXPECT_NEAR(irradiance(*source_of(light), Vec3f(0), kUp), kPi * radiance * sin2, 1e-3);
}

TEST(PointLight, soft_sphere_lights_as_a_point_where_it_is_wholly_above_the_horizon) {
    Light light = light_of(LightKind::Point, 100.0f, at({0, 0, 2}));
    light.radius = 0.5f;
    light.soft_falloff = false;
    EXPECT_NEAR(irradiance(*source_of(light), Vec3f(0), kUp), 100.0 / (4 * kPi * 4), 1e-3);
}

TEST(PointLight, soft_sphere_around_a_surface_lights_it_from_everywhere) {
    // The radiance is the same in all directions: pi times it, wherever inside.
    Light light = light_of(LightKind::Point, 100.0f, at({0, 0, 0.25}));
    light.radius = 0.5f;
    light.soft_falloff = false;
    const double radiance = 100.0 / (4 * kPi) / (kPi * 0.25);
    const auto source = source_of(light);
    for (const Vec3f& n : {kUp, -kUp, Vec3f(1, 0, 0)})
        EXPECT_NEAR(irradiance(*source, Vec3f(0), n), kPi * radiance, 2e-2 * radiance);
}

TEST(SunLight, irradiance_is_its_strength_whatever_its_angle) {
    for (const float angle : {0.0f, 0.00918f, 0.5f, 2.0f}) {
        Light light = light_of(LightKind::Sun, 3.0f, aimed({0, 0, 9}, {0, 0, -1}));
        light.sun_angle = angle;
        EXPECT_NEAR(irradiance(*source_of(light), Vec3f(5, 4, 0), kUp), 3.0, 1e-3) << angle;
    }
}

TEST(SunLight, flat_one_shines_alike_from_each_place_of_its_disc) {
    // The mean over a disc of radius r a metre away of the cosine 1 / sqrt(1 + rho^2).
    for (const double angle : {0.0, 0.00918, 0.6, 1.57, 2.5, M_PI}) {
        Light light = light_of(LightKind::Sun, 3.0f, aimed({0, 0, 9}, {0, 0, -1}));
        light.sun_angle = static_cast<float>(angle);
        light.sun_flat = true;
        const double r2 = std::pow(std::tan(angle / 2), 2);
        const double expected = r2 > 1e-6 ? 3.0 * 2 * (std::sqrt(1 + r2) - 1) / r2 : 3.0;
        EXPECT_NEAR(irradiance(*source_of(light), Vec3f(5, 4, 0), kUp), expected, 3e-3) << angle;
    }
}

TEST(SpotLight, is_a_point_light_inside_its_cone_and_dark_outside) {
    Light light = light_of(LightKind::Spot, 100.0f, aimed({0, 0, 2}, {0, 0, -1}));
    light.spot_size = 2.0f * std::atan(0.5f);  // reaches 1 m from the foot
    const auto sharp = source_of(light);
    const double on_axis = 100.0 / (4 * kPi * 4);
    EXPECT_NEAR(irradiance(*sharp, Vec3f(0), kUp), on_axis, 1e-6);
    EXPECT_GT(irradiance(*sharp, Vec3f(0.999f, 0, 0), kUp), 0.6 * on_axis);
    EXPECT_EQ(irradiance(*sharp, Vec3f(1.001f, 0, 0), kUp), 0.0);
    // Blend 1: smoothstep of the cosine from the cone's edge to its axis.
    light.spot_blend = 1.0f;
    const double cos_edge = std::cos(std::atan(0.5)), cos_p = std::cos(std::atan(0.25));
    const double t = (cos_p - cos_edge) / (1.0 - cos_edge);
    const double expected = 100.0 / (4 * kPi * 4.25) * cos_p * t * t * (3 - 2 * t);
    EXPECT_NEAR(irradiance(*source_of(light), Vec3f(0.5f, 0, 0), kUp), expected, 1e-5);
    // Before Blender 3.5 the cosine dimmed it too.
    light.spot_cosine = true;
    EXPECT_NEAR(irradiance(*source_of(light), Vec3f(0.5f, 0, 0), kUp), expected * cos_p, 1e-5);
}

TEST(SpotLight, scale_makes_its_cone_elliptic) {
    Light light = light_of(LightKind::Spot, 100.0f, aimed({0, 0, 2}, {0, 0, -1}));
    light.world_from_light[0][0] *= 2.0;
    light.spot_size = 2.0f * std::atan(0.5f);
    const Vec3f wide = Vec3f(Vec3d(glm::normalize(light.world_from_light[0][0]))) * 1.9f;
    const Vec3f narrow = Vec3f(Vec3d(glm::normalize(light.world_from_light[0][1]))) * 1.9f;
    const auto source = source_of(light);
    EXPECT_GT(irradiance(*source, wide, kUp), 0.0);
    EXPECT_EQ(irradiance(*source, narrow, kUp), 0.0);
}

/// Form factor from an element to a parallel rectangle a by b (in heights) with a corner straight
/// above it (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-4).
double corner_form_factor(double a, double b) {
    const double ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * kPi);
}

TEST(AreaLight, rectangle_over_a_floor) {
    Light light = light_of(LightKind::Area, 60.0f, aimed({0, 0, 1.5}, {0, 0, -1}));
    light.shape = AreaShape::Rectangle;
    light.size = {2.0f, 0.8f};
    const double radiance = 60.0 / (kPi * 2.0 * 0.8);
    const double factor = 4 * corner_form_factor(1.0 / 1.5, 0.4 / 1.5);
    EXPECT_NEAR(irradiance(*source_of(light), Vec3f(0), kUp), kPi * radiance * factor, 2e-3);
    EXPECT_EQ(irradiance(*source_of(light), Vec3f(0, 0, 3), -kUp), 0.0);  // behind it
}

TEST(AreaLight, a_square_that_is_scaled_keeps_its_watts) {
    Light light = light_of(LightKind::Area, 60.0f, aimed({0, 0, 1.5}, {0, 0, -1}));
    light.size = {1.0f, 7.0f};  // a square has no second size
    for (int axis = 0; axis < 2; ++axis) light.world_from_light[0][axis] *= 3.0;
    const double factor = 4 * corner_form_factor(1.0, 1.0);
    EXPECT_NEAR(irradiance(*source_of(light), Vec3f(0), kUp), 60.0 / 9.0 * factor, 2e-3);
}

TEST(AreaLight, disc_on_its_axis) {
    Light light = light_of(LightKind::Area, 60.0f, aimed({0, 0, 2}, {0, 0, -1}));
    light.shape = AreaShape::Disk;
    light.size = {1.0f, 1.0f};
    const double radiance = 60.0 / (kPi * kPi * 0.25);
    EXPECT_NEAR(irradiance(*source_of(light), Vec3f(0), kUp), kPi * radiance * 0.25 / (0.25 + 4.0),
                2e-3);
}

TEST(AreaLight, a_narrow_spread_sends_the_same_flux) {
    // Radiant exitance at the light: the integral of radiance times cosine over directions.
    for (const float spread : {3.1f, 1.5f, 0.3f, 0.06f}) {
        Light light = light_of(LightKind::Area, 60.0f, aimed({0, 0, 0}, {0, 0, 1}));
        light.size = {1e3f, 1e3f};
        light.spread = spread;
        const auto source = source_of(light);
        double sum = 0.0;
        const int steps = 20000;
        for (int i = 0; i < steps; ++i) {  // rings of equal dtheta, mid-points
            const double theta = (i + 0.5) * 0.5 * spread / steps;
            LightSample sample;
            const Vec3f to_light(static_cast<float>(std::sin(theta)), 0.0f,
                                 -static_cast<float>(std::cos(theta)));
            if (source->intersect(Vec3f(0, 0, 0.1f), to_light, sample))
                sum += sample.radiance.x * std::cos(theta) * std::sin(theta) * 2 * kPi * 0.5 *
                       spread / steps;
        }
        // Float cosines at 0.03 rad leave tan with 1e-4 relative error.
        EXPECT_NEAR(sum / (60.0 / 1e6), 1.0, 2e-3) << spread;
    }
}

// Below a wide softbox, as below an endless one: what it sends per area arrives.  Of samples all
// over the disc one in a hundred would do.
TEST(AreaLight, a_disc_of_little_spread_is_sampled_where_it_shines) {
    Light light = light_of(LightKind::Area, 60.0f, aimed({0, 0, 0.1}, {0, 0, -1}));
    light.shape = AreaShape::Disk;
    light.size = {1.0f, 1.0f};
    light.spread = 0.9f;
    const auto source = source_of(light);
    for (const Vec3f& p : {Vec3f(0.0f), Vec3f(0.3f, 0.2f, 0.0f), Vec3f(-0.43f, 0.0f, 0.0f)})
        EXPECT_NEAR(irradiance(*source, p, kUp, 64), 60.0 / (kPi * 0.25), 4.0);
    // Half of a circle about the rim's foot lies in the disc, but for its curvature.
    EXPECT_NEAR(irradiance(*source, Vec3f(0.5f, 0.0f, 0.0f), kUp, 1024), 30.0 / (kPi * 0.25), 2.0);
}

class EveryLight : public testing::TestWithParam<int> {
  protected:
    static Light make(int which) {
        const Mat4d place = aimed({0.3, -0.2, 2.0}, {0.1, 0.2, -1});
        Light light = light_of(LightKind::Point, 10.0f, place);
        if (which == 0) light.radius = 0.4f;
        if (which == 1) light.radius = 0.4f, light.soft_falloff = false;
        if (which == 2) light.kind = LightKind::Sun, light.sun_angle = 0.3f;
        if (which == 3)
            light.kind = LightKind::Spot, light.radius = 0.3f, light.spot_size = 2.4f,
            light.spot_blend = 0.5f;
        if (which >= 4) light.kind = LightKind::Area, light.size = {1.0f, 0.4f};
        if (which == 4) light.shape = AreaShape::Rectangle;
        if (which == 5) light.shape = AreaShape::Ellipse;
        if (which == 6) light.shape = AreaShape::Rectangle, light.spread = 1.0f;
        if (which == 7) light.shape = AreaShape::Ellipse, light.spread = 0.4f;
        return light;
    }
};

TEST_P(EveryLight, a_ray_along_a_sample_meets_it_with_the_same_density_and_radiance) {
    const auto source = source_of(make(GetParam()));
    const SobolPoints points(3);
    int met = 0, sampled = 0;
    for (std::uint32_t i = 0; i < 256; ++i) {
        const Vec3f p(-0.1f, 0.05f, 0.0f);
        LightSample sample, hit;
        // Points within 1e-4 of the rim may miss by rounding.
        const Vec2f u = points(i) * 0.998f + Vec2f(0.001f);
        if (!source->sample(p, u, sample)) continue;
        ++sampled;
        if (!source->intersect(p, sample.direction, hit)) continue;
        ++met;
        EXPECT_NEAR(hit.pdf / sample.pdf, 1.0f, 1e-3f);
        EXPECT_NEAR(hit.radiance.x, sample.radiance.x, 2e-3f * sample.radiance.x + 1e-6f);
        if (std::isfinite(sample.distance)) {
            EXPECT_NEAR(hit.distance, sample.distance, 1e-4f);
        }
    }
    EXPECT_GT(sampled, 100);
    EXPECT_GE(met, sampled - 2);
}

TEST_P(EveryLight, many_samples_at_once_are_those_of_one_at_a_time) {
    const auto source = source_of(make(GetParam()));
    const SobolPoints points(5);
    for (const std::size_t count : {1u, 16u, 17u, 33u}) {
        std::vector<Vec2f> u;
        for (std::uint32_t i = 0; i < count; ++i) u.push_back(points(i));
        for (const Vec3f& p : {Vec3f(0.2f, -0.1f, 1.2f), Vec3f(3.0f, 2.0f, 0.0f)}) {
            std::vector<LightSample> together(count);
            source->sample_all(p, u, together);
            for (std::size_t i = 0; i < count; ++i) {
                LightSample alone;
                const bool arrives = source->sample(p, u[i], alone);
                ASSERT_EQ(together[i].pdf > 0.0f, arrives) << i;
                if (!arrives) continue;
                EXPECT_EQ(together[i].direction, alone.direction) << i;
                EXPECT_EQ(together[i].distance, alone.distance) << i;
                EXPECT_EQ(together[i].radiance, alone.radiance) << i;
                EXPECT_EQ(together[i].pdf, alone.pdf) << i;
            }
        }
    }
}

TEST_P(EveryLight, its_density_integrates_to_one_over_the_directions_that_meet_it) {
    if (GetParam() >= 6) return;  // sampled over a square around the circle that reaches the point
    const auto source = source_of(make(GetParam()));
    // The smallest light here, the sun, catches 1500 of 2^18 uniform net points; of those only the
    // ones on its rim err.
    const SobolPoints points(11);
    const Vec3f p(0.2f, -0.1f, 1.2f);
    double sum = 0.0;
    const std::uint32_t count = 1u << 18;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3f direction = Basis(Vec3f(0, 0, 1)).to_world(sample_cone(points(i), 2.0f));
        LightSample sample;
        if (source->intersect(p, direction, sample)) sum += sample.pdf * 4 * kPi;
    }
    EXPECT_NEAR(sum / count, 1.0, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryLight, testing::Range(0, 8));

}  // namespace
}  // namespace granita
