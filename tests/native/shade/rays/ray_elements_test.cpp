// SPDX-License-Identifier: GPL-3.0-or-later
// Shadows of curves and points.
#include "shade/rays/ray_elements.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "dice/open_instance.h"
#include "math/sampling.h"
#include "shade/lights/light_scene.h"
#include "shade/rays/ray_scene.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
const Vec3f kUp(0, 0, 1);

/// One curve a list of points, all of one radius, in as many knots as `knots` has lists.
GeometryData curve(const std::vector<std::vector<Vec3f>>& knots, float radius) {
    GeometryData data;
    data.name = "curves 'Hair'";
    data.kind = GeometryKind::Curves;
    data.knots = static_cast<int>(knots.size());
    for (const auto& points : knots)
        data.points.insert(data.points.end(), points.begin(), points.end());
    data.curve_sizes = {static_cast<std::int32_t>(knots[0].size())};
    data.radius.assign(knots[0].size(), radius);
    return data;
}

GeometryData cloud(const std::vector<Vec3f>& points, float radius) {
    GeometryData data;
    data.name = "points 'Spray'";
    data.kind = GeometryKind::Points;
    data.points = points;
    data.radius.assign(points.size(), radius);
    return data;
}

/// A line along x, one metre above the ground.
std::vector<Vec3f> line(float y) {
    return {{-2, y, 1}, {-1, y, 1}, {0, y, 1}, {1, y, 1}, {2, y, 1}};
}

bool blocked(const RayScene& rays, const Vec3f& from, float time = 0.5f) {
    return rays.transmittance({from, kUp, kInfinity, time}) == Vec3f(0.0f);
}

TEST(RayElements, a_curve_blocks_as_far_as_its_radius) {
    Scene scene = empty_scene();
    add_instance(scene, curve({line(0)}, 0.1f), at({0, 0, 0}));
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    for (const float x : {-1.7f, -0.5f, 0.0f, 0.3f, 1.9f}) {
        for (const float y : {-0.099f, 0.0f, 0.05f, 0.099f}) EXPECT_TRUE(blocked(rays, {x, y, 0}));
        for (const float y : {-0.101f, 0.101f, 0.5f}) EXPECT_FALSE(blocked(rays, {x, y, 0}));
    }
    EXPECT_FALSE(blocked(rays, {2.2f, 0, 0}));
    EXPECT_GT(rays.bytes(), 0u);
}

TEST(RayElements, a_point_blocks_as_far_as_its_radius_and_its_instance_scales_it) {
    Scene scene = empty_scene();
    add_instance(scene, cloud({{0, 0, 1}, {1, 0, 1}}, 0.1f), at({0, 0, 0}));
    Mat4d twice = at({0, 3, 0});
    for (int i = 0; i < 3; ++i) twice[i] *= 2.0;
    add_instance(scene, cloud({{0, 0, 1}}, 0.1f), twice);
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    for (const float x : {0.0f, 1.0f}) {
        EXPECT_TRUE(blocked(rays, {x + 0.06f, 0.06f, 0}));
        EXPECT_FALSE(blocked(rays, {x + 0.08f, 0.08f, 0}));
    }
    EXPECT_TRUE(blocked(rays, {0.19f, 3, 0}));
    EXPECT_FALSE(blocked(rays, {0.21f, 3, 0}));
}

TEST(RayElements, places_and_radii_move_within_the_shutter) {
    Scene scene = empty_scene();
    GeometryData moving = curve({line(0), line(1)}, 0.0f);
    moving.radius = {.1f, .1f, .1f, .1f, .1f, .3f, .3f, .3f, .3f, .3f};
    add_instance(scene, std::move(moving), at({0, 0, 0}));
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    EXPECT_TRUE(rays.moves());
    for (const float t : {0.0f, 0.25f, 0.5f, 1.0f}) {
        const float r = 0.1f + 0.2f * t;
        EXPECT_TRUE(blocked(rays, {0.3f, t - r + 0.01f, 0}, t)) << t;
        EXPECT_TRUE(blocked(rays, {0.3f, t + r - 0.01f, 0}, t)) << t;
        EXPECT_FALSE(blocked(rays, {0.3f, t - r - 0.01f, 0}, t)) << t;
        EXPECT_FALSE(blocked(rays, {0.3f, t + r + 0.01f, 0}, t)) << t;
    }
}

TEST(RayElements, equal_knots_and_curves_of_a_point_cost_nothing) {
    Scene scene = empty_scene();
    add_instance(scene, curve({line(0), line(0)}, 0.1f), at({0, 0, 0}));
    add_instance(scene, curve({{{0, 0, 2}}}, 9.0f), at({0, 0, 0}));
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    EXPECT_FALSE(rays.moves());
    EXPECT_FALSE(blocked(rays, {0, 0.5f, 0}));
}

TEST(RayElements, transparent_ones_tell_where_they_were_met) {
    Scene scene = empty_scene();
    scene.materials.resize(1);
    GeometryData two = curve({line(0)}, 0.1f);
    for (const Vec3f& p : line(1)) two.points.push_back(p);
    two.radius.resize(10, 0.1f);
    two.curve_sizes = {5, 5};
    scene.instances[add_instance(scene, two, at({0, 0, 0}))].materials = {0};
    scene.instances[add_instance(scene, cloud({{9, 9, 9}, {0.6f, 1, 2}}, 0.1f), at({0, 0, 0}))]
        .materials = {0};
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t) { return true; };
    int curves = 0, points = 0;
    opacity.transparency = [&](const RayHit& hit, RayType) {
        EXPECT_EQ(hit.place.element, 1u);
        EXPECT_EQ(hit.direction, kUp);
        if (hit.elements->data().kind == GeometryKind::Points) {
            ++points;
            return Vec3f(0.25f);
        }
        ++curves;
        // x runs from -2 by one a segment.
        EXPECT_NEAR(static_cast<double>(hit.place.point) - 5.0 + hit.place.fraction - 2.0, 0.6,
                    .01);
        return Vec3f(0.5f);
    };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    const Vec3f left = rays.transmittance({{0.6f, 1.02f, 0}, kUp, kInfinity});
    EXPECT_EQ(curves, 1);
    EXPECT_GE(points, 1);
    EXPECT_EQ(left, Vec3f(0.5f * std::pow(0.25f, static_cast<float>(points))));
}

/// Rays from diced points to all sides that their normals see.
float passing(Scene scene) {
    scene.options.width = scene.options.height = 256;
    scene.camera.projection.scale = {400.0, 400.0};
    scene.camera.projection.center = {128.0, 128.0};
    scene.camera.projection.near_clip = 0.01;
    Report report;
    View view;
    view.scene = &scene;
    view.projection = scene.camera.projection;
    const auto opened = open_instance(view, 0, report);
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    long cast = 0, passed = 0;
    const std::function<void(const Primitive&)> look = [&](const Primitive& primitive) {
        if (!primitive.diceable()) {
            for (const auto& child : primitive.split()) look(*child);
            return;
        }
        const auto grid = primitive.dice();
        grid->shading_state(*grid);
        for (std::size_t i = 0; i < grid->point_count(); ++i) {
            const Vec3f start = rays.ray_offset(grid->key)(
                grid->shading_p()[i] + grid->ray_offset[i], grid->geometric_normal[i]);
            const SobolPoints sequence(i);
            for (std::uint32_t s = 0; s < 16; ++s) {
                const Vec2f u = sequence(s);
                const float z = 1 - 2 * u.x, r = std::sqrt(1 - z * z), a = 6.2831853f * u.y;
                const Vec3f direction(r * std::cos(a), r * std::sin(a), z);
                if (glm::dot(direction, grid->normal[i]) < 0.02f) continue;
                ++cast;
                passed += rays.transmittance({start, direction, kInfinity}) == Vec3f(1.0f);
            }
        }
    };
    for (std::size_t i = 0; i < opened->primitive_count(); ++i) look(*opened->primitive(i));
    EXPECT_GT(cast, 200);
    return static_cast<float>(passed) / static_cast<float>(cast);
}

TEST(RayElements, a_hair_lights_as_a_tube_and_does_not_shade_itself) {
    for (const float radius : {0.002f, 0.02f, 0.05f}) {
        Scene scene = empty_scene();
        add_instance(
            scene, curve({{{-.2f, 0, 2}, {-.1f, .03f, 2}, {0, 0.04f, 2.05f}, {.2f, 0, 2}}}, radius),
            at({0, 0, 0}));
        // The rest meet the inside of the bend.
        EXPECT_GT(passing(std::move(scene)), 0.98f) << radius;
    }
}

TEST(RayElements, a_sphere_does_not_shade_itself) {
    for (const float radius : {0.001f, 0.01f, 0.2f}) {
        Scene scene = empty_scene();
        std::vector<Vec3f> points;
        for (int i = 0; i < 9; ++i)
            points.emplace_back(0.45f * static_cast<float>(i % 3) - 0.45f,
                                0.45f * static_cast<float>(i / 3) - 0.45f, 3.0f);
        add_instance(scene, cloud(radius < 0.1f ? points : std::vector<Vec3f>{{0, 0, 3}}, radius),
                     at({0, 0, 0}));
        EXPECT_GT(passing(std::move(scene)), 0.99f) << radius;
    }
}

}  // namespace
}  // namespace granita
