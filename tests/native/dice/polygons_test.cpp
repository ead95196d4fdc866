// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "dice/dice_scene.h"

namespace granita::testing {
namespace {

Mat4d rotation(double angle, const Vec3d& axis) {
    const Vec3d a = glm::normalize(axis);
    const double c = std::cos(angle), s = std::sin(angle);
    Mat4d m(1.0);
    for (int i = 0; i < 3; ++i) {
        Vec3d e(0.0);
        e[i] = 1.0;
        m[i] = glm::dvec4(e * c + glm::cross(a, e) * s + a * glm::dot(a, e) * (1.0 - c), 0.0);
    }
    return m;
}

Mat4d translation(const Vec3d& d) {
    Mat4d m(1.0);
    m[3] = glm::dvec4(d, 1.0);
    return m;
}

TEST(Polygons, a_square_is_diced_at_the_rate) {
    for (const float rate : {0.4f, 1.0f, 3.0f}) {
        DiceScene s(
            mesh({{-40, -40, 1}, {40, -40, 1}, {40, 40, 1}, {-40, 40, 1}}, {4}, {0, 1, 2, 3}),
            rate);
        const auto grids = s.grids();
        EXPECT_NEAR(area(grids), 6400.0, 1e-2);
        for (const auto& grid : grids) {
            EXPECT_LE(grid->micropolygon_count(), 256);
            for (int m = 0; m < grid->micropolygon_count(); ++m) {
                const Grid::Corners c = grid->corners(m);
                for (const auto& [a, b] : {std::pair{c.v0, c.v1}, std::pair{c.v0, c.v3}}) {
                    const double length =
                        glm::distance(Vec3d(grid->positions[a]), Vec3d(grid->positions[b]));
                    EXPECT_GT(length, rate * M_SQRT1_2 * 0.9999);
                    EXPECT_LE(length, rate * M_SQRT2 * 1.0001);
                }
            }
        }
    }
}

TEST(Polygons, grid_size_is_the_users) {
    for (const int size : {1, 2, 16, 100, 1024}) {
        DiceScene s(mesh({{-20, -20, 1}, {30, -25, 1}, {20, 20, 1}, {-20, 25, 1}, {0, 60, 1}},
                         {4, 3}, {0, 1, 2, 3, 3, 2, 4}),
                    1.0f, size);
        const auto grids = s.grids();
        ASSERT_FALSE(grids.empty());
        for (const auto& grid : grids) EXPECT_LE(grid->micropolygon_count(), size);
        // Shoelace: the quad (-20,-20) (30,-25) (20,20) (-20,25), the triangle on its top.
        EXPECT_NEAR(area(grids), 2000.0 + 750.0, 1e-2);
    }
}

TEST(Polygons, every_rate_of_two_neighbours_closes) {
    // Orthographic pixels are metres: edges of 1, 3, 5, 7 and 63 pixels meet.
    DiceScene s(cube(0.5f));
    for (const Vec3d& size : {Vec3d(1, 7, 1), Vec3d(3, 5, 1), Vec3d(63, 1, 9), Vec3d(.3, .3, .3),
                              Vec3d(100, 100, 37)}) {
        Mat4d scale(1.0);
        for (int i = 0; i < 3; ++i) scale[i][i] = size[i];
        s.scene.instances[0].world_from_object = {rotation(0.7, {1, 2, 3}) * scale};
        const auto grids = s.grids();
        EXPECT_TRUE(open_edges(grids).empty()) << size.x << " " << open_edges(grids).size();
        EXPECT_NEAR(area(grids), 2 * (size.x * size.y + size.y * size.z + size.z * size.x),
                    1e-5 * area(grids));
    }
}

TEST(Polygons, perspective_closes_near_and_far) {
    for (const int grid_size : {4, 256}) {
        DiceScene s(cube(0.5f), 1.0f, grid_size);
        s.perspective();
        s.view.projection.near_clip = 1e-3;
        Mat4d scale(1.0);
        scale[2][2] = 40.0;  // one end close to the eye, the other far away
        s.scene.instances[0].world_from_object = {translation({0.1, 0.2, 20.5}) *
                                                  rotation(0.05, {1, 1, 0}) * scale};
        const auto grids = s.grids();
        EXPECT_TRUE(open_edges(grids).empty());
        EXPECT_NEAR(area(grids), 2 + 4 * 40, 1e-2);
    }
}

TEST(Polygons, random_closed_meshes_close) {
    // A noisy octahedron-like ball of triangles, quads and pentagons around every rate.
    std::mt19937 random(7);
    std::uniform_real_distribution<float> noise(-0.3f, 0.3f);
    for (int round = 0; round < 20; ++round) {
        GeometryData data = cube(1.0f);
        for (Vec3f& p : data.points) p += Vec3f(noise(random), noise(random), noise(random));
        DiceScene s(data, 1.0f, 64);
        s.perspective(12.0 * (round + 1));
        s.scene.options.width = s.scene.options.height = 1024;
        s.scene.instances[0].world_from_object = {translation({0, 0, 3}) *
                                                  rotation(round, {1, 0.3, 0.2})};
        const auto grids = s.grids();
        EXPECT_TRUE(open_edges(grids).empty()) << round;
    }
}

TEST(Polygons, a_concave_polygon_is_filled_exactly_once) {
    // A comb: 2 wide bars of 10 x 40 on a base of 50 x 10, corners in the plane of a tilted square.
    std::vector<Vec3f> p = {{0, 0, 0},   {50, 0, 0},  {50, 50, 0}, {40, 50, 0},
                            {40, 10, 0}, {10, 10, 0}, {10, 50, 0}, {0, 50, 0}};
    for (Vec3f& q : p) q = Vec3f(q.x, 0.8f * q.y, 0.6f * q.y);
    DiceScene s(mesh(p, {8}, {0, 1, 2, 3, 4, 5, 6, 7}));
    const auto grids = s.grids();
    EXPECT_NEAR(area(grids), 500 + 2 * 400, 1e-2);
    // Its border is that of the polygon: nothing open inside.
    double length = 0.0;
    for (const auto& [a, b] : open_edges(grids)) length += glm::distance(a, b);
    EXPECT_NEAR(length, 50 + 2 * 50 + 2 * 10 + 2 * 40 + 30, 1e-2);
    for (const auto& grid : grids)
        for (const Vec3f& n : grid->geometric_normal)
            EXPECT_NEAR(glm::dot(n, Vec3f(0, -0.6f, 0.8f)), 1.0f, 1e-5f);
    EXPECT_TRUE(s.report.warnings().empty());
}

TEST(Polygons, a_concave_quad_does_not_fold) {
    DiceScene s(mesh({{0, 0, 0}, {40, 0, 0}, {10, 10, 0}, {0, 40, 0}}, {4}, {0, 1, 2, 3}));
    EXPECT_NEAR(area(s.grids()), 400.0, 1e-2);
}

TEST(Polygons, a_crossing_polygon_is_reported) {
    DiceScene s(
        mesh({{0, 0, 0}, {40, 0, 0}, {0, 40, 0}, {40, 41, 0}, {20, 60, 0}}, {5}, {0, 1, 2, 3, 4}));
    EXPECT_FALSE(s.grids().empty());
    ASSERT_EQ(s.report.warnings().size(), 1u);
    EXPECT_EQ(s.report.warnings()[0].datablock, "mesh 'Test'");
}

/// A square of w pixels whose third corner is lifted by k: Blender cuts it to that corner, so that
/// z = k min(x, y) / w.
GeometryData bent_square(float w, float k) {
    return mesh({{0, 0, 0}, {w, 0, 0}, {w, w, k}, {0, w, 0}}, {4}, {0, 1, 2, 3});
}

TEST(Polygons, a_quad_that_is_not_flat_is_two_triangles) {
    // Bent by 4 and by 38 degrees; of several grids, of one, and of a few pixels.
    for (const float w : {64.0f, 12.0f, 3.0f, 1.0f})
        for (const float k : {w / 16, w / 2}) {
            DiceScene s(bent_square(w, k));
            const auto grids = s.grids();
            EXPECT_NEAR(area(grids), w * std::sqrt(w * w + k * k), 1e-4 * w * w);
            const Vec3f lower = glm::normalize(Vec3f(0, -k, w));
            const Vec3f upper = glm::normalize(Vec3f(-k, 0, w));
            const Vec3f crease = glm::normalize(lower + upper);
            for (const auto& grid : grids) {
                for (const Vec3f& p : grid->positions)
                    EXPECT_NEAR(p.z, k * std::min(p.x, p.y) / w, 1e-5 * w);
                const std::vector<Vec3f>& points = grid->shading_p();
                for (std::size_t i = 0; i < grid->normal.size(); ++i) {
                    const Vec3f& p = points[i];
                    const Vec3f& n = grid->normal[i];
                    if (std::abs(p.x - p.y) > 1e-3f)
                        EXPECT_NEAR(glm::distance(n, p.x > p.y ? lower : upper), 0.0f, 1e-5f);
                    else  // of one of them, or of both by area
                        EXPECT_LT(std::min({glm::distance(n, lower), glm::distance(n, upper),
                                            glm::distance(n, crease)}),
                                  1e-5f);
                }
            }
        }
}

TEST(Polygons, normals_and_maps_are_linear_in_each_triangle) {
    // A trapezoid, flat: as one bilinear patch its map would bend.
    for (const float w : {64.0f, 12.0f}) {
        DiceScene s(mesh({{0, 0, 0}, {w, 0, 0}, {w / 2, w, 0}, {0, w, 0}}, {4}, {0, 1, 2, 3}));
        Attribute uv;
        uv.name = "UVMap";
        uv.kind = AttributeKind::Uv;
        uv.domain = Domain::Corner;
        uv.width = 2;
        uv.values = {0, 0, 1, 0, 1, 1, 0, 1};
        s.scene.geometries[0].attributes.push_back(uv);
        const std::vector<Vec3f> corner = {
            {0, 0, 1}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}, {-0.8f, 0, 0.6f}};
        s.scene.geometries[0].corner_normals = corner;
        s.view.requests = {{{AttributeSource::DefaultUv, "", 2, true}}};
        std::size_t points = 0;
        for (const auto& grid : s.grids()) {
            const std::vector<Vec3f>& at = grid->shading_p();
            for (std::size_t i = 0; i < at.size(); ++i, ++points) {
                const float x = at[i].x / w, y = at[i].y / w;  // the crease: x = y / 2
                const bool lower = x > 0.5f * y;
                // Weights of the second and third corner below it, of the third and fourth above.
                const float b = lower ? x - 0.5f * y : 2 * x, c = lower ? y : y - 2 * x;
                const Vec2f map = lower ? Vec2f(b + c, c) : Vec2f(b, b + c);
                EXPECT_NEAR(grid->attributes[0].values[2 * i], map.x, 1e-5f);
                EXPECT_NEAR(grid->attributes[0].values[2 * i + 1], map.y, 1e-5f);
                const Vec3f n =
                    (1 - b - c) * corner[0] + b * corner[lower ? 1 : 2] + c * corner[lower ? 2 : 3];
                EXPECT_NEAR(glm::distance(grid->normal[i], glm::normalize(n)), 0.0f, 1e-5f);
            }
        }
        EXPECT_GT(points, 100u);
    }
}

TEST(Polygons, blenders_own_triangles_of_a_face_of_many_corners_are_taken) {
    // An L, not flat: whichever way it is cut decides where its middle lies.
    GeometryData data =
        mesh({{0, 0, 0}, {40, 0, 0}, {40, 20, 9}, {20, 20, 0}, {20, 40, 5}, {0, 40, 0}}, {6},
             {0, 1, 2, 3, 4, 5});
    const std::vector<std::array<int, 3>> cut = {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}};
    for (const auto& t : cut)
        data.ngon_triangles.insert(data.ngon_triangles.end(), t.begin(), t.end());
    double expected = 0.0;
    for (const auto& [a, b, c] : cut)
        expected += 0.5 * glm::length(glm::cross(Vec3d(data.points[static_cast<std::size_t>(b)] -
                                                       data.points[static_cast<std::size_t>(a)]),
                                                 Vec3d(data.points[static_cast<std::size_t>(c)] -
                                                       data.points[static_cast<std::size_t>(a)])));
    DiceScene s(data);
    const auto grids = s.grids();
    EXPECT_NEAR(area(grids), expected, 1e-3);
    for (const auto& grid : grids)
        for (const Vec3f& p : grid->positions) {
            if (!(p.x < 20 && p.y < 20)) continue;
            EXPECT_NEAR(p.z, 0.0f, 1e-5f);  // (0, 1, 3) and (0, 3, 5)
        }
}

TEST(Polygons, slivers_and_repeated_vertices_give_no_nan) {
    DiceScene s(mesh({{0, 0, 0}, {50, 0, 0}, {50, 1e-4f, 0}, {0, 1e-4f, 0}, {0, 0, 0}, {9, 9, 9}},
                     {4, 3, 4, 3, 4}, {0, 1, 2, 3, 0, 4, 0, 0, 0, 1, 1, 5, 5, 5, 0, 1, 0, 1}));
    s.scene.geometries[0].smooth.assign(5, 1);
    for (const auto& grid : s.grids()) {
        for (const auto* list :
             {&grid->positions, &grid->normal, &grid->geometric_normal, &grid->dp_du, &grid->dp_dv})
            for (const Vec3f& v : *list) EXPECT_TRUE(is_finite(v));
        for (const Vec3f& n : grid->normal) EXPECT_NEAR(glm::length(n), 1.0f, 1e-5f);
    }
    s.scene.instances[0].world_from_object = {Mat4d(0.0)};
    s.scene.instances[0].world_from_object[0][3][3] = 1.0;
    for (const auto& grid : s.grids())
        for (const Vec3f& n : grid->normal) EXPECT_NEAR(glm::length(n), 1.0f, 1e-5f);
}

TEST(Polygons, a_face_with_a_nan_is_left_out_and_named_the_rest_is_the_same) {
    const auto run = [](bool bad) {
        auto data = mesh({{0, 0, 0}, {30, 0, 0}, {30, 30, 0}, {0, 30, 0}, {60, 0, 0}, {60, 30, 0}},
                         {4, 4}, {0, 1, 2, 3, 1, 4, 5, 2});
        if (bad) data.points[4].y = std::numeric_limits<float>::quiet_NaN();
        DiceScene s(data);
        auto grids = s.grids();
        return std::pair(std::move(grids), s.report.warnings());
    };
    auto [good, none] = run(false);
    auto [rest, warnings] = run(true);
    EXPECT_TRUE(none.empty());
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].datablock, "mesh 'Test'");
    EXPECT_NE(warnings[0].message.find("1 face"), std::string::npos);
    ASSERT_EQ(rest.size() * 2, good.size());
    for (std::size_t i = 0; i < rest.size(); ++i) {
        EXPECT_EQ(rest[i]->key, good[i]->key);
        EXPECT_EQ(rest[i]->positions, good[i]->positions);
    }
}

TEST(Polygons, keys_are_unique) {
    DiceScene s(cube(60.0f), 1.0f, 64);
    std::set<GridKey> keys;
    const auto grids = s.grids();
    for (const auto& grid : grids) EXPECT_TRUE(keys.insert(grid->key).second);
    EXPECT_GT(grids.size(), 100u);
}

TEST(Polygons, normals_follow_the_faces_the_smooth_flag_and_the_custom_normals) {
    DiceScene s(cube(10.0f));
    // Flat: each face its own; the outside is the outside although camera space is left-handed.
    Mat4d flip(1.0);
    flip[2][2] = -1.0;
    s.scene.camera.world_from_camera = {flip};
    for (const auto& grid : s.grids())
        for (std::size_t i = 0; i < grid->normal.size(); ++i) {
            EXPECT_EQ(grid->normal[i], grid->geometric_normal[i]);
            EXPECT_GT(glm::dot(grid->normal[i], grid->positions[i]), 9.99f);
        }
    s.scene.camera.world_from_camera = {Mat4d(1.0)};
    s.view.geometries = std::make_shared<GeometryCache>();
    s.scene.geometries[0].smooth.assign(6, 1);
    for (const auto& grid : s.grids())
        for (std::size_t i = 0; i < grid->normal.size(); ++i) {
            // On a cube the interpolated normal is the direction from the centre of a bilinear
            // blend of the corner directions: that of the position itself.
            EXPECT_NEAR(glm::dot(grid->normal[i], glm::normalize(grid->positions[i])), 1.0f, 1e-5f);
        }
    // A mirrored instance keeps its outside.
    Mat4d mirror(1.0);
    mirror[0][0] = -2.0;
    s.scene.instances[0].world_from_object = {mirror};
    for (const auto& grid : s.grids())
        for (std::size_t i = 0; i < grid->normal.size(); ++i)
            EXPECT_GT(glm::dot(grid->geometric_normal[i], grid->positions[i]), 9.99f);
    s.view.geometries = std::make_shared<GeometryCache>();
    s.scene.geometries[0].corner_normals.assign(24, glm::normalize(Vec3f(1, 1, 1)));
    for (const auto& grid : s.grids())
        for (const Vec3f& n : grid->normal)
            EXPECT_NEAR(glm::distance(n, glm::normalize(Vec3f(-0.5f, 1, 1))), 0.0f, 1e-6f);
}

TEST(Polygons, derivatives_are_the_parametric_ones_times_the_step) {
    DiceScene s(mesh({{0, 0, 0}, {40, 0, 0}, {40, 30, 7}, {0, 30, 7}, {60, 3, 1}}, {4, 3},
                     {0, 1, 2, 3, 1, 4, 2}));
    Attribute uv;
    uv.name = "UVMap";
    uv.kind = AttributeKind::Uv;
    uv.domain = Domain::Corner;
    uv.width = 2;
    uv.values = {0, 0, 1, 0, 1, 1, 0, 1, 1, 0, 2, 0, 1, 1};
    s.scene.geometries[0].attributes.push_back(uv);
    s.view.requests = {{{AttributeSource::DefaultUv, "", 2, true},
                        {AttributeSource::Generated, "", 3, true},
                        {AttributeSource::ObjectPosition, "", 3, true},
                        {AttributeSource::Named, "nothing", 3, true}}};
    const auto check = [](const Grid& grid, const float* values, const float* du, const float* dv,
                          int width, float tolerance) {
        // Differences over two steps of what is at most quadratic are exact at the middle one,
        // inside the grid where no vertex was moved onto an edge's.
        for (int j = 2; j < grid.n_v - 1; ++j)
            for (int i = 2; i < grid.n_u - 1; ++i)
                for (int c = 0; c < width; ++c) {
                    const int row = grid.n_u + 1, v = j * row + i;
                    EXPECT_NEAR(du[v * width + c],
                                0.5f * (values[(v + 1) * width + c] - values[(v - 1) * width + c]),
                                tolerance);
                    EXPECT_NEAR(
                        dv[v * width + c],
                        0.5f * (values[(v + row) * width + c] - values[(v - row) * width + c]),
                        tolerance);
                }
    };
    for (const auto& grid : s.grids()) {
        if (grid->key.face == 0)  // a triangle's narrow end takes the middle's step
            check(*grid, &grid->positions[0].x, &grid->dp_du[0].x, &grid->dp_dv[0].x, 3, 1e-4f);
        ASSERT_EQ(grid->attributes.size(), 4u);
        for (const GridAttribute& a : grid->attributes) {
            ASSERT_EQ(a.values.size(), static_cast<std::size_t>(grid->vertex_count() * a.width));
            if (grid->key.face == 0)
                check(*grid, a.values.data(), a.du.data(), a.dv.data(), a.width, 1e-4f);
        }
        for (std::size_t i = 0; i < grid->positions.size(); ++i) {
            const Vec3f p = grid->positions[i];
            EXPECT_NEAR(glm::distance(p, Vec3f(grid->attributes[2].values[3 * i],
                                               grid->attributes[2].values[3 * i + 1],
                                               grid->attributes[2].values[3 * i + 2])),
                        0.0f, 1e-4f);
            EXPECT_NEAR(grid->attributes[1].values[3 * i], p.x / 60.0f, 1e-5f);
            EXPECT_EQ(grid->attributes[3].values[3 * i], 0.0f);
            EXPECT_GT(glm::length(grid->dp_du[i]), 0.0f);
            EXPECT_GT(glm::length(grid->dp_dv[i]), 0.0f);
        }
    }
}

TEST(Polygons, generated_coordinates_are_the_geometrys_own_or_those_of_its_box) {
    for (const bool subdivided : {false, true})
        for (const bool own : {false, true}) {
            GeometryData data =
                mesh({{0, 0, 0}, {40, 0, 0}, {40, 20, 0}, {0, 20, 0}}, {4}, {0, 1, 2, 3});
            data.is_subdivision = subdivided;
            data.subdivision.boundary = SubdivisionBoundary::EdgeAndCorner;
            if (own) data.generated = {{2, 3, 4}, {6, 3, 4}, {6, 5, 4}, {2, 5, 4}};
            DiceScene s(data);
            s.view.requests = {{{AttributeSource::Generated, "", 3, true}}};
            for (const auto& grid : s.grids())
                for (std::size_t i = 0; i < grid->positions.size(); ++i) {
                    const Vec3f& p = grid->positions[i];
                    const Vec3f expected = own ? Vec3f(2 + p.x / 10, 3 + p.y / 10, 4)
                                               : Vec3f(p.x / 40, p.y / 20, 0.5f);
                    for (int c = 0; c < 3; ++c)
                        EXPECT_NEAR(grid->attributes[0].values[3 * i + static_cast<std::size_t>(c)],
                                    expected[c], 1e-5f);
                    EXPECT_NEAR(grid->attributes[0].du[3 * i],
                                grid->dp_du[i].x / (own ? 10.0f : 40.0f), 1e-5f);
                }
        }
}

TEST(Polygons, what_the_frame_shows_of_a_large_face_is_diced_finely) {
    // All sides lie outside the frame and are coarse; the frame looks at the face's middle, or at a
    // part of it that neither middle line crosses.
    for (const float shift : {0.0f, 25.0f}) {
        const float lo = -60.0f - shift, hi = 60.0f - shift;
        DiceScene s(
            mesh({{lo, lo, 49}, {hi, lo, 49}, {hi, hi, 49}, {lo, hi, 49}}, {4}, {0, 1, 2, 3}));
        s.perspective(256.0);
        int seen = 0;
        for (const auto& grid : s.grids()) {
            const RasterBounds& b = grid->bounds;
            if (b.x1 < 0 || b.y1 < 0 || b.x0 > 256 || b.y0 > 256) continue;
            // No micropolygon of it is wider than twice the rate on average.
            EXPECT_LE(b.x1 - b.x0, 2.0f * static_cast<float>(grid->n_u) + 1.0f);
            EXPECT_LE(b.y1 - b.y0, 2.0f * static_cast<float>(grid->n_v) + 1.0f);
            seen += grid->micropolygon_count();
        }
        EXPECT_GE(seen, 256 * 256 / 2);
    }
}

}  // namespace
}  // namespace granita::testing
