// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_subdivision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/cages.h"
#include "shade/lights/light_scene.h"
#include "shade/rays/ray_scene.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// n x n cage quads over `size` metres around the origin, z from `height(x, y)`.
template <class Height>
GeometryData cage(int n, float size, Height height) {
    return sheet_cage(n, [&](int i, int j) {
        const Vec2f p = size * (Vec2f(i, j) / static_cast<float>(n) - Vec2f(0.5f));
        return Vec3f(p, height(p.x, p.y));
    });
}

/// Hills of 100 m by 100 m in faces of 10 m, seen from 1.5 m above them where x = y = 0.
Scene hills() {
    Scene scene = empty_scene();
    add_instance(
        scene,
        cage(10, 100.0f,
             [](float x, float y) { return 2.0f * std::sin(0.2f * x) * std::cos(0.17f * y); }),
        Mat4d(1.0));
    scene.camera.world_from_camera = {Mat4d(1.0)};
    scene.camera.world_from_camera[0][3] = {0.0, 0.0, 1.5, 1.0};
    scene.camera.projection.perspective = true;
    scene.camera.projection.scale = {1000.0, 1000.0};
    return scene;
}

TEST(RaySubdivision, rays_start_less_than_a_pixel_above_the_surface_and_meet_it_from_below) {
    const Scene scene = hills();
    const Vec3d eye(scene.camera.world_from_camera[0][3]);
    const Progress progress;
    const RayScene rays(scene, eye, {}, progress);
    Report report;
    const SharedGeometry shared(scene.geometries[0], 0.0f, report);
    for (const BasePatch& patch : shared.patches()) {
        const RayOffset offset = rays.ray_offset({scene.instances[0].key, patch.face});
        double nearest = kInfinity;
        for (int i = 0; i <= 8; ++i)
            for (int j = 0; j <= 8; ++j)
                nearest = std::min(
                    nearest, glm::distance(limit_point(shared, patch, Vec2d(i, j) / 8.0).p, eye));
        // A pixel is a thousandth of the distance.
        EXPECT_LE(offset.error, 1e-3 * nearest + 1e-4) << patch.face;
        for (const Vec2d uv : {Vec2d(0.5), Vec2d(0.13, 0.71), Vec2d(0.92, 0.38)}) {
            const LimitPoint at = limit_point(shared, patch, uv);
            const Vec3f p(at.p - eye), normal(at.normal);
            EXPECT_EQ(rays.transmittance({offset(p, normal), normal, 1.0f}), Vec3f(1.0f));
            const Vec3f below = p - normal * (2.0f * offset.error + 1e-3f);
            EXPECT_EQ(rays.transmittance({below, normal, 1.0f}), Vec3f(0.0f));
        }
    }
}

TEST(RaySubdivision, faces_of_different_numbers_of_cells_meet_without_gaps) {
    const Scene scene = hills();
    const Vec3d eye(scene.camera.world_from_camera[0][3]);
    const Progress progress;
    const RayScene rays(scene, eye, {}, progress);
    Report report;
    const SharedGeometry shared(scene.geometries[0], 0.0f, report);
    // Along all edges inside the sheet, from above and slantwise.
    int passed = 0;
    for (const BasePatch& patch : shared.patches()) {
        if (patch.face % 10 == 0 || patch.face < 10) continue;
        for (int i = 0; i < 500; ++i)
            for (const bool along_u : {true, false}) {
                const double t = (i + M_1_PI) / 500.0;  // through no vertex
                const Vec2d uv = along_u ? Vec2d(t, 0.0) : Vec2d(0.0, t);
                const Vec3f p(limit_point(shared, patch, uv).p - eye);
                const Vec3f down = glm::normalize(Vec3f(0.2f, -0.3f, -1.0f));
                if (rays.transmittance({p - 20.0f * down, down, 40.0f}) != Vec3f(0.0f)) ++passed;
            }
    }
    EXPECT_EQ(passed, 0);
}

TEST(RaySubdivision, what_is_flat_is_one_quad_a_face) {
    Report report;
    const Progress progress;
    Scene scene = hills();
    scene.geometries[0] = cage(10, 100.0f, [](float x, float y) { return 0.1f * x - 0.2f * y; });
    const auto shared = std::make_shared<SharedGeometry>(scene.geometries[0], 0.0f, report);
    const RayDetail detail(scene, 0, shared->frame_box());
    EXPECT_EQ(RaySubdivision(shared, detail, progress).quad_count(), 100u);
}

TEST(RaySubdivision, a_face_of_a_simple_cage_reaches_as_far_as_its_corners) {
    Report report;
    const Progress progress;
    Scene scene = hills();
    scene.geometries[0] =
        cage(10, 100.0f, [](float x, float y) { return 20.0f * std::sin(0.2f * x) * std::cos(y); });
    GeometryData& data = scene.geometries[0];
    data.subdivision.scheme = SubdivisionScheme::Simple;
    const auto shared = std::make_shared<SharedGeometry>(data, 0.0f, report);
    const RaySubdivision shape(shared, RayDetail(scene, 0, shared->frame_box()), progress);
    EXPECT_GT(shape.quad_count(), data.face_count());
    for (std::size_t face = 0; face < data.face_count(); ++face) {
        float reach = 0.0f;
        for (std::size_t i = 4 * face; i < 4 * face + 4; ++i) {
            const Vec3f p = glm::abs(data.points[static_cast<std::size_t>(data.corner_verts[i])]);
            reach = std::max({reach, p.x, p.y, p.z});
        }
        EXPECT_FLOAT_EQ(shape.extent(static_cast<std::uint32_t>(face)), reach) << face;
    }
}

}  // namespace
}  // namespace granita
