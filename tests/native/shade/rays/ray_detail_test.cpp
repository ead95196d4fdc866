// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_detail.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shade/lights/light_scene.h"

namespace granita {
namespace {

const Bounds3f kBox{Vec3f(-0.5f), Vec3f(0.5f)};

/// One unit quad, placed by each of the matrices.
Scene scene_of(const std::vector<Mat4d>& matrices) {
    Scene scene = empty_scene();
    add_instance(scene,
                 quads("mesh 'Quad'",
                       {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}}),
                 matrices.front());
    for (std::size_t i = 1; i < matrices.size(); ++i) {
        scene.instances.push_back(scene.instances.front());
        scene.instances.back().world_from_object = {matrices[i]};
    }
    return scene;
}

Mat4d scaled(const Vec3d& by) {
    Mat4d m(1.0);
    for (int axis = 0; axis < 3; ++axis) m[axis][axis] = by[axis];
    return m;
}

TEST(RayDetail, an_orthographic_pixel_is_as_large_everywhere) {
    Scene scene = scene_of({at({3.0, 4.0, -100.0}) * scaled({1.0, 4.0, 2.0})});
    scene.camera.projection.perspective = false;
    scene.camera.projection.scale = {40.0, 50.0};  // pixels a metre
    const RayDetail detail(scene, 0, kBox);
    // Of the finer direction on the raster, and of the axis that the object stretches most.
    for (const Vec3f& p : {Vec3f(0.0f), Vec3f(0.5f, -0.5f, 7.0f)})
        EXPECT_NEAR(detail.pixel(p), 1.0 / 50.0 / 4.0, 1e-8);
}

TEST(RayDetail, a_perspective_pixel_grows_with_the_distance_in_the_space_of_the_object) {
    Scene scene = scene_of({at({0.0, 0.0, -10.0}) * scaled(Vec3d(2.0))});
    scene.camera.projection.perspective = true;
    scene.camera.projection.scale = {1000.0, 800.0};
    const RayDetail detail(scene, 0, kBox);
    // Ten metres are five of the object's units, whose thousandth is a pixel's side.
    EXPECT_NEAR(detail.pixel(Vec3f(0.0f)), 5.0 / 1000.0, 1e-8);
    EXPECT_NEAR(detail.pixel({0.0f, 0.0f, -5.0f}), 10.0 / 1000.0, 1e-8);
}

TEST(RayDetail, of_many_instances_the_nearest_that_casts_counts) {
    std::vector<Mat4d> matrices;
    for (int i = 0; i < 40; ++i) matrices.push_back(at({0.0, 0.0, -50.0 + i}));
    Scene scene = scene_of(matrices);
    scene.camera.projection.perspective = true;
    scene.camera.projection.scale = {1000.0, 1000.0};
    const auto pixel = [&] { return RayDetail(scene, 0, kBox).pixel(Vec3f(0.0f)); };
    EXPECT_NEAR(pixel(), 11.0 / 1000.0, 1e-8);
    scene.instances.back().casts_shadow = false;
    EXPECT_NEAR(pixel(), 12.0 / 1000.0, 1e-8);
    for (Instance& instance : scene.instances) instance.casts_shadow = false;
    EXPECT_TRUE(std::isinf(pixel()));
}

}  // namespace
}  // namespace granita
