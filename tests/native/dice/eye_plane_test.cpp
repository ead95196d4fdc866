// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases 17, 47 and 60: geometry through the near plane, behind the camera, and very large.
#include <algorithm>
#include <functional>
#include <limits>

#include "dice/dice_scene.h"

namespace granita::testing {
namespace {

/// A square of `size` metres around the camera's feet, `height` below it.
GeometryData ground(float size, float height) {
    const float s = 0.5f * size;
    return mesh({{-s, -height, -s}, {-s, -height, s}, {s, -height, s}, {s, -height, -s}}, {4},
                {0, 1, 2, 3});
}

TEST(EyePlane, a_ground_of_1e5_metres_costs_little_and_reaches_the_horizon) {
    DiceScene s(ground(1e5f, 1.6f));
    s.perspective(256.0);
    const auto grids = s.grids();
    // 128 rows of 256 pixels lie below the horizon; what is outside the frame coarsens away.  Five
    // a pixel are those of patches seen at a grazing angle: wide, but without height.
    EXPECT_LT(micropolygons(grids), 12 * 128 * 256);
    EXPECT_TRUE(open_edges(grids).size() > 0);  // its four sides
    float top = 0.0f;
    for (const auto& grid : grids)
        for (const Vec3f& p : grid->positions)
            if (p.z > 0.1f) top = std::max(top, 128.0f + 256.0f * p.y / p.z);
    // The far edge: 256 * 1.6 / 5e4 pixels under the horizon.
    EXPECT_NEAR(top, 128.0f - 256.0f * 1.6f / 5e4f, 1e-4f);
}

/// Whether the micropolygons cover a raster point exactly once (odd-even over triangles in front).
int covers(const std::vector<std::unique_ptr<Grid>>& grids, const Projection& projection, double x,
           double y) {
    int covered = 0;
    for (const auto& grid : grids)
        for (int m = 0; m < grid->micropolygon_count(); ++m) {
            const Grid::Corners c = grid->corners(m);
            for (const auto& t : {std::array{c.v0, c.v1, c.v2}, std::array{c.v0, c.v2, c.v3}}) {
                Vec3d h[3];
                for (int i = 0; i < 3; ++i)
                    h[i] = Vec3d(projection.homogeneous(
                        grid->positions[static_cast<std::size_t>(t[static_cast<std::size_t>(i)])],
                        Vec2d(x, y)));
                const double a = h[0].x * h[1].y - h[0].y * h[1].x,
                             b = h[1].x * h[2].y - h[1].y * h[2].x,
                             d = h[2].x * h[0].y - h[2].y * h[0].x;
                const bool all = (a > 0 && b > 0 && d > 0) || (a < 0 && b < 0 && d < 0);
                const double w = (h[2].z * a + h[0].z * b + h[1].z * d) / (a + b + d);
                if (all && w > 0) ++covered;
            }
        }
    return covered;
}

TEST(EyePlane, no_holes_from_the_feet_to_the_horizon) {
    for (const float height : {0.2f, 1.6f, 30.0f}) {
        DiceScene s(ground(1e5f, height));
        s.perspective(64.0);
        s.scene.options.width = s.scene.options.height = 64;
        s.view.projection.center = {32.0, 32.0};
        const auto grids = s.grids();
        for (int i = 0; i < 300; ++i) {
            const double x = 64.0 * std::fmod(i * 0.618034, 1.0);
            const double y = (32.0 - 64.0 * height / 5e4) * std::fmod(i * 0.414214, 1.0);
            EXPECT_EQ(covers(grids, s.view.projection, x, y), 1) << x << " " << y;
        }
    }
}

TEST(EyePlane, walls_through_the_camera_in_every_direction_are_bounded) {
    for (int round = 0; round < 40; ++round) {
        const double angle = round * 0.7, tilt = round * 0.37;
        const Vec3d x(std::cos(angle), std::sin(angle) * std::cos(tilt),
                      std::sin(angle) * std::sin(tilt)),
            other(0.3, -0.2, 0.9);
        const Vec3d n = glm::normalize(glm::cross(x, other)), y = glm::cross(n, x);
        const double off = round % 2 ? 0.0 : 0.01;  // exactly through the eye, and just beside it
        std::vector<Vec3f> p;
        for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
            p.push_back(
                Vec3f(1e4 * (x * static_cast<double>(a) + y * static_cast<double>(b)) + n * off));
        DiceScene s(mesh(p, {4}, {0, 1, 2, 3}));
        s.perspective(256.0);
        s.view.projection.near_clip = 1e-3;
        const auto grids = s.grids();
        EXPECT_LT(micropolygons(grids), 20 * 256 * 256) << round;
        for (const auto& grid : grids)
            for (const Vec3f& v : grid->positions) ASSERT_TRUE(is_finite(v));
    }
}

TEST(EyePlane, what_is_wholly_behind_or_beyond_is_not_visible) {
    for (const float z : {-10.0f, 2e7f}) {
        DiceScene s(cube(1.0f, z));
        s.perspective();
        EXPECT_FALSE(instance_bounds(s.view, 0).visible);
        EXPECT_TRUE(s.grids().empty());
    }
}

TEST(EyePlane, a_cube_around_the_camera_closes) {
    for (const bool subdivided : {false, true}) {
        GeometryData data = cube(5.0f);
        data.is_subdivision = subdivided;
        DiceScene s(data, 2.0f);
        s.perspective(256.0);
        // Everything, whatever is visible: closed all around.
        std::vector<std::unique_ptr<Grid>> grids;
        const auto opened = open_instance(s.view, 0, s.report);
        const std::function<void(const Primitive&)> walk = [&](const Primitive& primitive) {
            if (primitive.diceable())
                grids.push_back(primitive.dice());
            else
                for (const auto& child : primitive.split()) walk(*child);
        };
        for (std::size_t i = 0; i < opened->primitive_count(); ++i) walk(*opened->primitive(i));
        EXPECT_TRUE(open_edges(grids).empty());
        EXPECT_LT(micropolygons(grids), 20 * 256 * 256);
    }
}

/// Whatever a vertex shows between the clips, at any time and through any lens point, lies inside
/// the bounds.
void expect_inside(const Grid& grid, const Projection& projection) {
    const int n = grid.vertex_count();
    for (int v = 0; v < n; ++v)
        for (int step = 0; step <= 64; ++step) {
            const float t = static_cast<float>(step) / 64.0f;
            const Vec3f a = grid.positions[static_cast<std::size_t>(v)];
            const Vec3f b = grid.positions[static_cast<std::size_t>((grid.knots - 1) * n + v)];
            const Vec3f p = a + t * (b - a);
            if (p.z < projection.near_clip || p.z > projection.far_clip) continue;
            for (const double focus : {projection.focus, projection.farthest_focus()})
                for (const double lens : {-1.0, 0.0, 1.0}) {
                    const Vec3d h = projection.homogeneous(p, {0.0, 0.0});
                    const Vec2d shift =
                        lens * projection.lens_radius * (p.z / focus - 1.0) * projection.scale;
                    const double x = (h.x + shift.x) / h.z, y = (h.y + shift.y) / h.z;
                    ASSERT_TRUE(x >= grid.bounds.x0 && x <= grid.bounds.x1) << x << " at t " << t;
                    ASSERT_TRUE(y >= grid.bounds.y0 && y <= grid.bounds.y1) << y << " at t " << t;
                }
        }
}

TEST(EyePlane, dollying_through_the_near_plane_keeps_the_swept_bound) {
    // Hard case 17: z = 2 - 3 t.
    DiceScene s(mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {4}, {0, 1, 2, 3}));
    s.perspective(500.0);
    Mat4d start(1.0), end(1.0);
    start[3][2] = 2.0;
    end[3][2] = -1.0;
    s.scene.instances[0].world_from_object = {start, end};
    const auto grids = s.grids();
    ASSERT_FALSE(grids.empty());
    EXPECT_NEAR(area(grids, 0), 4.0, 1e-5);
    EXPECT_NEAR(area(grids, 1), 4.0, 1e-5);
    for (const auto& grid : grids) {
        EXPECT_TRUE(grid->bounds.visible);
        EXPECT_EQ(grid->bounds.nearest_key, 1.0f / 0.1f);
        expect_inside(*grid, s.view.projection);
    }
    EXPECT_LT(micropolygons(grids), 4 * 256 * 256);
}

TEST(EyePlane, a_floor_below_the_lens_stays_below_the_frame) {
    DiceScene s(
        mesh({{-50, -2, -50}, {50, -2, -50}, {50, -2, 50}, {-50, -2, 50}}, {4}, {0, 1, 2, 3}));
    s.perspective(256.0);
    s.view.projection.lens_radius = 0.05;
    s.view.projection.focus = 8.0;
    for (const auto& grid : s.grids()) expect_inside(*grid, s.view.projection);
    // The horizon is half-way up; what lies nearer than 2 m is outside the frame whatever the lens
    // does.
    const auto opened = open_instance(s.view, 0, s.report);
    EXPECT_LE(opened->bounds(0).y1, 128.0f + 256.0f * 0.05f / 8.0f + 1.0f);
}

TEST(EyePlane, a_lens_widens_bounds_by_its_circle_of_confusion) {
    DiceScene s(mesh({{0, 0, 4}, {0.01f, 0, 4}, {0, 0.01f, 4}}, {3}, {0, 1, 2}));
    s.perspective(256.0);
    s.view.projection.lens_radius = 0.1;
    s.view.projection.focus = 8.0;
    const double circle = 256.0 * 0.1 * (1.0 / 4.0 - 1.0 / 8.0);
    const auto grids = s.grids();
    ASSERT_EQ(grids.size(), 1u);
    for (const RasterBounds& b : {grids[0]->bounds, instance_bounds(s.view, 0),
                                  open_instance(s.view, 0, s.report)->bounds(0)}) {
        EXPECT_NEAR(b.x0, 128.0 - circle, 0.02);
        EXPECT_NEAR(b.x1, 128.0 + 256.0 * 0.01 / 4.0 + circle, 0.02);
        EXPECT_LE(b.x0, 128.0 - circle);
    }
}

TEST(EyePlane, a_lens_that_moves_widens_bounds_by_its_widest_circle) {
    DiceScene s(mesh({{0, 0, 4}, {0.01f, 0, 4}, {0, 0.01f, 4}}, {3}, {0, 1, 2}));
    s.perspective(256.0);
    // At 4 m the circle of the nearer focus is the larger; on its way it is sharp there.
    const LensKnots lens({{0.02, 8.0}, {0.1, 2.0}}, s.view.projection);
    const double circle = 256.0 * 0.1 * (1.0 / 2.0 - 1.0 / 4.0);
    const auto grids = s.grids();
    ASSERT_EQ(grids.size(), 1u);
    expect_inside(*grids[0], s.view.projection);
    EXPECT_NEAR(grids[0]->bounds.x0, 128.0 - circle, 0.02);
    EXPECT_NEAR(grids[0]->bounds.y1, 128.0 + 256.0 * 0.01 / 4.0 + circle, 0.02);
}

TEST(EyePlane, off_screen_geometry_is_coarse_and_crop_does_not_matter) {
    DiceScene s(mesh({{-500, -20, 5},
                      {-400, -20, 5},
                      {-400, 20, 5},
                      {-500, 20, 5},
                      {-100, -20, 5},
                      {-100, 20, 5}},
                     {4, 4}, {0, 1, 2, 3, 1, 4, 5, 2}));
    const auto whole = s.grids();
    EXPECT_LT(micropolygons(whole), 140 * 40 + 1000);  // 28 x 40 pixels in the frame
    s.scene.options.crop = {100, 100, 110, 110};
    s.view.raster_x0 = s.view.raster_y0 = 98;
    s.view.raster_x1 = s.view.raster_y1 = 112;
    const auto cropped = s.grids();
    ASSERT_EQ(whole.size(), cropped.size());
    for (std::size_t i = 0; i < whole.size(); ++i)
        EXPECT_EQ(whole[i]->positions, cropped[i]->positions);
}

}  // namespace
}  // namespace granita::testing
