// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/dice_scene.h"
#include "dice/knots.h"

namespace granita::testing {
namespace {

Mat4d translation(double x, double y, double z) {
    Mat4d m(1.0);
    m[3] = glm::dvec4(x, y, z, 1.0);
    return m;
}

GeometryData square(float half) {
    return mesh({{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {4},
                {0, 1, 2, 3});
}

TEST(Knots, combine_to_the_least_common_multiple) {
    Scene scene;
    scene.camera.world_from_camera = {Mat4d(1.0), translation(2, 0, 0), translation(6, 0, 0)};
    scene.options.frame_time = 0.5f;
    Instance instance;
    instance.world_from_object = {translation(0, 0, 0), translation(0, 3, 0), translation(0, 6, 0),
                                  translation(0, 0, 0)};
    GeometryData geometry = square(1.0f);
    const Knots knots = combine_knots(scene, instance, geometry, true);
    ASSERT_EQ(knots.count, 7);  // 2 and 3 segments
    EXPECT_FALSE(knots.capped);
    // Knot 3 is the camera's middle one and halfway between the object's second and third.
    const Vec3d p = transform_point(knots.camera_from_object[3], Vec3d(0.0));
    EXPECT_EQ(p, Vec3d(-2.0, 4.5, 0.0));
    EXPECT_EQ(transform_point(knots.camera_from_object[6], Vec3d(0.0)), Vec3d(-6.0, 0.0, 0.0));
    EXPECT_EQ(knots.frame_knot, 3);
    EXPECT_EQ(knots.frame_fraction, 0.0);
}

TEST(Knots, frame_time_between_knots) {
    Scene scene;
    scene.camera.world_from_camera = {Mat4d(1.0)};
    scene.options.frame_time = 0.5f;
    Instance instance;
    instance.world_from_object = {translation(0, 0, 0), translation(8, 0, 0)};
    const Knots knots = combine_knots(scene, instance, square(1.0f), true);
    EXPECT_EQ(knots.count, 2);
    EXPECT_EQ(knots.frame_knot, 0);
    EXPECT_EQ(knots.frame_fraction, 0.5);
    EXPECT_EQ(transform_point(knots.frame_camera_from_object, Vec3d(0.0)), Vec3d(4.0, 0.0, 0.0));
}

TEST(Knots, too_many_are_capped_and_said_so) {
    Scene scene;
    for (int i = 0; i <= 16; ++i) scene.camera.world_from_camera.push_back(translation(i, 0, 0));
    Instance instance;
    for (int i = 0; i <= 17; ++i) instance.world_from_object.push_back(translation(0, i, 0));
    const Knots knots = combine_knots(scene, instance, square(1.0f), true);
    EXPECT_EQ(knots.count, kMaxKnots);
    EXPECT_TRUE(knots.capped);
    // Linear motion is held exactly all the same.
    const Vec3d p = transform_point(knots.camera_from_object[64], Vec3d(0.0));
    EXPECT_NEAR(glm::distance(p, Vec3d(-8.0, 8.5, 0.0)), 0.0, 1e-12);
}

TEST(Motion, equal_knots_cost_nothing) {
    DiceScene s(square(20.0f));
    s.scene.instances[0].world_from_object.assign(5, translation(1, 2, 3));
    for (const auto& grid : s.grids()) {
        EXPECT_EQ(grid->knots, 1);
        EXPECT_FALSE(grid->motion);
        EXPECT_TRUE(grid->p.empty());
    }
    // Moving with the camera is standing still.
    const std::vector<Mat4d> path = {translation(0, 0, 0), translation(4, 0, 0),
                                     translation(8, 2, 0)};
    s.scene.instances[0].world_from_object = s.scene.camera.world_from_camera = path;
    for (const auto& grid : s.grids()) EXPECT_EQ(grid->knots, 1);
}

TEST(Motion, what_appears_has_knots_though_it_stands_still) {
    for (const std::size_t knots : {1u, 5u})
        for (const bool subdivided : {false, true}) {
            GeometryData data = square(20.0f);
            data.is_subdivision = subdivided;
            DiceScene s(data);
            s.scene.options.frame_time = 0.5f;
            s.scene.instances[0].world_from_object.assign(knots, translation(1, 2, 3));
            s.scene.instances[0].lifespan = {0.25f, 0.5f};
            EXPECT_TRUE(s.scene.moves());
            const auto grids = s.grids();
            ASSERT_FALSE(grids.empty());
            for (const auto& grid : grids) {
                EXPECT_EQ(grid->lifespan, (Lifespan{0.25f, 0.5f}));
                EXPECT_TRUE(grid->motion);
                ASSERT_EQ(grid->knots, 2);
                const auto n = static_cast<std::ptrdiff_t>(grid->vertex_count());
                const std::vector<Vec3f> first(grid->positions.begin(),
                                               grid->positions.begin() + n);
                EXPECT_TRUE(std::equal(first.begin(), first.end(), grid->positions.begin() + n));
                EXPECT_EQ(grid->p, first);
            }
        }
}

TEST(Motion, what_never_exists_is_nowhere) {
    for (const Lifespan life : {Lifespan{0.5f, 0.5f}, {1.5f, 2.0f}, {-2.0f, 0.0f}}) {
        DiceScene s(square(20.0f));
        s.scene.instances[0].lifespan = life;
        EXPECT_FALSE(instance_bounds(s.view, 0).visible);
    }
    DiceScene s(square(20.0f));
    s.scene.instances[0].lifespan = {-1.0f, 1.5f};
    EXPECT_TRUE(instance_bounds(s.view, 0).visible);
    EXPECT_FALSE(s.scene.moves());
}

TEST(Motion, positions_at_knots_and_at_the_frame) {
    GeometryData data = square(20.0f);
    data.knots = 3;  // grows by a tenth, then by another
    for (const float scale : {1.1f, 1.2f})
        for (int v = 0; v < 4; ++v)
            data.points.push_back(data.points[static_cast<std::size_t>(v)] * scale);
    for (const bool subdivided : {false, true}) {
        data.is_subdivision = subdivided;
        data.subdivision.scheme = SubdivisionScheme::Simple;
        DiceScene s(data);
        s.scene.options.frame_time = 0.5f;
        s.scene.instances[0].world_from_object = {translation(0, 0, 0), translation(30, 0, 0)};
        const auto grids = s.grids();
        EXPECT_NEAR(area(grids, 0), 1600.0, 0.05);
        EXPECT_NEAR(area(grids, 1), 1600.0 * 1.21, 0.05);
        EXPECT_NEAR(area(grids, 2), 1600.0 * 1.44, 0.05);
        for (const auto& grid : grids) {
            ASSERT_EQ(grid->knots, 3);
            EXPECT_TRUE(grid->motion);
            const std::size_t n = static_cast<std::size_t>(grid->vertex_count());
            ASSERT_EQ(grid->p.size(), n);
            for (std::size_t i = 0; i < n; ++i) {
                EXPECT_EQ(grid->p[i], grid->positions[n + i]);
                const Vec3f start = grid->positions[i];
                EXPECT_NEAR(grid->positions[n + i].x, 1.1f * start.x + 15.0f, 1e-4f);
                EXPECT_NEAR(grid->positions[2 * n + i].x, 1.2f * start.x + 30.0f, 1e-4f);
            }
            // The bound is swept.
            float lo = 1e9f, hi = -1e9f;
            for (const Vec3f& p : grid->positions)
                lo = std::min(lo, p.x + 128.0f), hi = std::max(hi, p.x + 128.0f);
            EXPECT_LE(grid->bounds.x0, lo);
            EXPECT_GE(grid->bounds.x1, hi);
            EXPECT_GT(grid->bounds.x0, lo - 0.01f);
            EXPECT_LT(grid->bounds.x1, hi + 0.01f);
        }
        s.scene.options.frame_time = 0.0f;
        s.view.geometries = std::make_shared<GeometryCache>();
        for (const auto& grid : s.grids()) EXPECT_EQ(grid->p[3], grid->positions[3]);
    }
}

TEST(Motion, the_largest_knot_decides_the_rate_and_all_knots_close) {
    for (const bool subdivided : {false, true}) {
        GeometryData data = cube(20.0f);
        data.is_subdivision = subdivided;
        data.knots = 3;
        for (int k = 1; k < 3; ++k)
            for (int v = 0; v < 8; ++v) {
                Vec3f p = data.points[static_cast<std::size_t>(v)];
                if (k == 1) p.x *= 4.0f;
                if (k == 2) p.y *= 3.0f - p.z / 20.0f;
                data.points.push_back(p);
            }
        DiceScene s(data, 1.5f, 100);
        s.scene.instances[0].world_from_object = {translation(0, 0, 0), translation(5, 9, 2)};
        const auto coarser = s.grids();
        for (int knot = 0; knot < 3; ++knot) EXPECT_TRUE(open_edges(coarser, knot).empty()) << knot;
        s.scene.options.motion_factor = 0.0f;  // lengths are what they are without blur
        const auto grids = s.grids();
        EXPECT_LT(micropolygons(coarser), micropolygons(grids));
        for (int knot = 0; knot < 3; ++knot) {
            EXPECT_TRUE(open_edges(grids, knot).empty()) << knot;
            for (const auto& grid : grids) {
                ASSERT_EQ(grid->knots, 3);
                if (subdivided) continue;
                const Vec3f* p =
                    &grid->positions[static_cast<std::size_t>(knot * grid->vertex_count())];
                for (int m = 0; m < grid->micropolygon_count(); ++m) {
                    const Grid::Corners c = grid->corners(m);
                    // Border vertices may sit on a coarser neighbour's; inside, the image's x and
                    // y are within the rate and the five hundredths that equal halves may differ.
                    const int i = m % grid->n_u, j = m / grid->n_u;
                    if (i == 0 || j == 0 || i == grid->n_u - 1 || j == grid->n_v - 1) continue;
                    EXPECT_LE(glm::distance(Vec2f(p[c.v0]), Vec2f(p[c.v1])), 1.5f * 1.485f);
                    EXPECT_LE(glm::distance(Vec2f(p[c.v0]), Vec2f(p[c.v3])), 1.5f * 1.485f);
                }
            }
        }
    }
}

TEST(Motion, a_transform_that_is_not_finite_leaves_the_instance_out) {
    DiceScene s(square(20.0f));
    s.scene.instances[0].world_from_object[0][3][0] = NAN;
    EXPECT_TRUE(s.grids().empty());
    EXPECT_FALSE(instance_bounds(s.view, 0).visible);
    ASSERT_EQ(s.report.warnings().size(), 1u);
    EXPECT_EQ(s.report.warnings()[0].datablock, "object 'Test'");
}

TEST(Motion, scenes_far_from_the_origin_keep_their_bits) {
    // Hard case 48: a power of two keeps the offset exact in double.
    DiceScene near(cube(20.0f));
    DiceScene far(cube(20.0f));
    near.scene.camera.world_from_camera = {translation(1, 2, 3)};
    const double d = 1 << 26;
    far.scene.camera.world_from_camera = {translation(1 + d, 2 - d, 3 + d)};
    far.scene.instances[0].world_from_object = {translation(d, -d, d)};
    const auto a = near.grids(), b = far.grids();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i]->positions, b[i]->positions);
}

}  // namespace
}  // namespace granita::testing
