// SPDX-License-Identifier: GPL-3.0-or-later
#include <functional>
#include <limits>
#include <random>

#include "dice/dice_scene.h"

namespace granita::testing {
namespace {

GeometryData smooth_cube(float half, float z = 0.0f) {
    GeometryData data = cube(half, z);
    data.is_subdivision = true;
    return data;
}

/// A tetrahedron: triangles only, so that all faces are sub-faces and all edges are halved.
GeometryData smooth_tetrahedron(float size) {
    GeometryData data =
        mesh({{size, size, size}, {size, -size, -size}, {-size, size, -size}, {-size, -size, size}},
             {3, 3, 3, 3}, {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2});
    data.is_subdivision = true;
    return data;
}

/// A prism over a pentagon: n-gons next to quads.
GeometryData smooth_prism(float radius, float height) {
    std::vector<Vec3f> p;
    for (int ring = 0; ring < 2; ++ring)
        for (int i = 0; i < 5; ++i)
            p.emplace_back(radius * std::cos(i * 2 * M_PI / 5), radius * std::sin(i * 2 * M_PI / 5),
                           ring ? height : -height);
    std::vector<std::int32_t> sizes{5, 5}, corners{4, 3, 2, 1, 0, 5, 6, 7, 8, 9};
    for (int i = 0; i < 5; ++i) {
        sizes.push_back(4);
        for (const int v : {i, (i + 1) % 5, 5 + (i + 1) % 5, 5 + i}) corners.push_back(v);
    }
    GeometryData data = mesh(p, sizes, corners);
    data.is_subdivision = true;
    return data;
}

TEST(Subdivision, closed_cages_close_at_every_rate) {
    for (const float rate : {0.7f, 3.0f, 11.0f, 1000.0f})
        for (const GeometryData& data :
             {smooth_cube(30.0f), smooth_tetrahedron(25.0f), smooth_prism(40.0f, 7.0f)}) {
            DiceScene s(data, rate, 64);
            const auto grids = s.grids();
            ASSERT_FALSE(grids.empty());
            EXPECT_TRUE(open_edges(grids).empty()) << rate << ": " << open_edges(grids).size();
            for (const auto& grid : grids) EXPECT_LE(grid->micropolygon_count(), 64);
        }
}

TEST(Subdivision, straight_edges_of_n_gons_and_quads_share_their_middles) {
    // Nothing but the n-gon's own corner there has their edges cut in two.
    GeometryData prism = smooth_prism(40.0f, 7.0f);
    prism.subdivision.scheme = SubdivisionScheme::Simple;
    DiceScene s(prism, 1000.0f, 64);
    const auto grids = s.grids();
    ASSERT_FALSE(grids.empty());
    EXPECT_TRUE(open_edges(grids).empty()) << open_edges(grids).size();
}

TEST(Subdivision, perspective_with_very_different_rates_closes) {
    for (const GeometryData& data :
         {smooth_cube(1.0f), smooth_tetrahedron(1.0f), smooth_prism(1.5f, 1.0f)}) {
        DiceScene s(data, 1.0f, 128);
        s.perspective(60.0);
        Mat4d m(1.0);
        m[2][2] = 6.0;
        m[0][2] = 0.4;
        m[3] = glm::dvec4(0.1, 0.2, 6.5, 1.0);
        s.scene.instances[0].world_from_object = {m};
        const auto grids = s.grids();
        EXPECT_TRUE(open_edges(grids).empty()) << open_edges(grids).size();
    }
}

TEST(Subdivision, cube_limit_touches_its_known_points) {
    // Hard case 54: corners of the +-1 cube go to (.5, .5, .5), face centres to 68/81.
    const float half = 20.0f;
    DiceScene s(smooth_cube(half));
    double largest = 0.0, nearest_corner = 1e9;
    for (const auto& grid : s.grids())
        for (std::size_t i = 0; i < grid->positions.size(); ++i) {
            const Vec3d p = Vec3d(grid->positions[i]) / static_cast<double>(half);
            largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
            nearest_corner = std::min(nearest_corner, glm::distance(glm::abs(p), Vec3d(0.5)));
            EXPECT_NEAR(glm::length(grid->normal[i]), 1.0f, 1e-5f);
            // Star-shaped about its centre: every normal points away from it.
            EXPECT_GT(glm::dot(grid->normal[i], grid->positions[i]), 0.0f);
        }
    EXPECT_NEAR(largest, 68.0 / 81.0, 1e-5);
    EXPECT_LT(nearest_corner, 1e-5);
}

TEST(Subdivision, infinitely_sharp_edges_keep_the_polyhedron) {
    GeometryData data = smooth_cube(30.0f);
    for (int a = 0; a < 8; ++a)
        for (int bit : {1, 2, 4})
            if (!(a & bit)) {
                data.subdivision.crease_verts.insert(data.subdivision.crease_verts.end(),
                                                     {a, a | bit});
                data.subdivision.crease_values.push_back(10.0f);
            }
    DiceScene s(data);
    const auto grids = s.grids();
    EXPECT_NEAR(area(grids), 6 * 60.0 * 60.0, 1e-3 * 6 * 60 * 60);
    EXPECT_TRUE(open_edges(grids).empty());
}

TEST(Subdivision, one_creased_edge_stays_straight) {
    // The edge 0-1 and both its ends pinned by creases along it only: its limit is the B-spline
    // curve of a straight line, so y and z stay put although the cube around it is rounded.
    GeometryData data = smooth_cube(30.0f);
    data.subdivision.crease_verts = {0, 1};
    data.subdivision.crease_values = {10.0f};
    data.subdivision.vertex_creases.assign(8, 0.0f);
    data.subdivision.vertex_creases[0] = data.subdivision.vertex_creases[1] = 10.0f;
    DiceScene s(data);
    int on_edge = 0;
    for (const auto& grid : s.grids())
        for (const Vec3f& p : grid->positions)
            if (p.y < -29.999f && p.z < -29.999f) ++on_edge;
    EXPECT_GT(on_edge, 60);
}

TEST(Subdivision, uvs_follow_the_face_varying_rule) {
    // A 2 x 1 strip whose UVs equal its positions: linear everywhere, so any rule keeps u = x.
    GeometryData data =
        mesh({{0, 0, 0}, {40, 0, 0}, {80, 0, 0}, {0, 40, 0}, {40, 40, 0}, {80, 40, 0}}, {4, 4},
             {0, 1, 4, 3, 1, 2, 5, 4});
    data.is_subdivision = true;
    data.subdivision.boundary = SubdivisionBoundary::EdgeAndCorner;
    Attribute uv;
    uv.name = "UVMap";
    uv.kind = AttributeKind::Uv;
    uv.domain = Domain::Corner;
    uv.width = 2;
    for (const std::int32_t v : data.corner_verts) {
        uv.values.push_back(data.points[static_cast<std::size_t>(v)].x);
        uv.values.push_back(data.points[static_cast<std::size_t>(v)].y);
    }
    data.attributes = {uv};
    data.subdivision.uv = SubdivisionUv::PreserveCorners;
    DiceScene s(data);
    s.view.requests = {{{AttributeSource::DefaultUv, "", 2, true},
                        {AttributeSource::ObjectPosition, "", 3, true}}};
    for (const auto& grid : s.grids())
        for (std::size_t i = 0; i < grid->positions.size(); ++i) {
            const GridAttribute& a = grid->attributes[0];
            // With the corners kept, both are the same cubic B-spline of the same values.
            EXPECT_NEAR(a.values[2 * i], grid->positions[i].x, 2e-4);
            EXPECT_NEAR(a.values[2 * i + 1], grid->positions[i].y, 2e-4);
            EXPECT_NEAR(a.du[2 * i], grid->dp_du[i].x, 2e-4);
            EXPECT_NEAR(a.dv[2 * i + 1], grid->dp_dv[i].y, 2e-4);
            const GridAttribute& p = grid->attributes[1];
            EXPECT_NEAR(p.values[3 * i], grid->positions[i].x, 2e-4);
            EXPECT_NEAR(p.dv[3 * i + 1], grid->dp_dv[i].y, 2e-4);
        }
}

/// A square of 3 x 3 quads whose UVs bend, each corner's own moved by up to `noise`.
GeometryData mapped_cage(float noise) {
    std::vector<Vec3f> p;
    std::vector<std::int32_t> corners;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) p.emplace_back(20.0f * i, 20.0f * j, 0.0f);
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
            for (const int v : {4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4})
                corners.push_back(v);
    GeometryData data = mesh(p, std::vector<std::int32_t>(9, 4), corners);
    data.is_subdivision = true;
    Attribute uv;
    uv.name = "UVMap";
    uv.kind = AttributeKind::Uv;
    uv.domain = Domain::Corner;
    uv.width = 2;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> jitter(-noise, noise);
    for (const std::int32_t v : corners) {
        const int i = v % 4, j = v / 4;
        uv.values.push_back(0.3f * i + (j == 1 ? 0.1f : 0.0f) + jitter(random));
        uv.values.push_back(0.3f * j + (i == 2 ? 0.1f : 0.0f) + jitter(random));
    }
    data.attributes = {uv};
    return data;
}

TEST(Subdivision, uvs_that_nearly_agree_are_smoothed_as_one) {
    // Blender joins what is nearer than 1e-4; a seam instead moves this map by .02.
    const auto map = [](float noise) {
        DiceScene s(mapped_cage(noise));
        s.view.requests = {{{AttributeSource::DefaultUv, "", 2, false}}};
        std::vector<float> values;
        for (const auto& grid : s.grids())
            values.insert(values.end(), grid->attributes[0].values.begin(),
                          grid->attributes[0].values.end());
        return values;
    };
    const auto largest = [](const std::vector<float>& a, const std::vector<float>& b) {
        float most = 0.0f;
        for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
        return most;
    };
    const std::vector<float> clean = map(0.0f), near = map(4e-5f), apart = map(4e-4f);
    ASSERT_EQ(clean.size(), near.size());
    EXPECT_LT(largest(clean, near),
              5e-5f);  // weights of a smooth map are positive, and add up to 1
    EXPECT_GT(largest(clean, apart), 0.01f);
}

/// A closed ring of n x n quads: every vertex has four, all faces are regular.
GeometryData smooth_torus(float radius, float tube, int n) {
    std::vector<Vec3f> p;
    std::vector<std::int32_t> corners;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double a = i * 2 * M_PI / n, b = j * 2 * M_PI / n,
                         r = radius + tube * std::cos(b);
            p.emplace_back(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
            for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
                corners.push_back((j + dj) % n * n + (i + di) % n);
        }
    GeometryData data =
        mesh(p, std::vector<std::int32_t>(static_cast<std::size_t>(n * n), 4), corners);
    data.is_subdivision = true;
    return data;
}

TEST(Subdivision, derivatives_are_central_differences_in_the_limit_of_small_steps) {
    // Regular faces: second order, steps of half a unit on radii of about thirty.  Where a face has
    // an irregular vertex OpenSubdiv's own derivatives are those of a Gregory patch without its
    // rational terms (far/patchBasis): measured within 1.3 %.
    for (const auto& [data, tolerance] : {std::pair{smooth_torus(60.0f, 30.0f, 8), 3e-3f},
                                          std::pair{smooth_prism(40.0f, 30.0f), 2e-2f}}) {
        DiceScene s(data, 0.5f);
        int checked = 0;
        for (const auto& grid : s.grids())
            for (int j = 2; j < grid->n_v - 1; ++j)
                for (int i = 2; i < grid->n_u - 1; ++i) {
                    const std::size_t row = static_cast<std::size_t>(grid->n_u) + 1,
                                      v = static_cast<std::size_t>(j) * row +
                                          static_cast<std::size_t>(i);
                    const Vec3f du = 0.5f * (grid->positions[v + 1] - grid->positions[v - 1]);
                    const Vec3f dv = 0.5f * (grid->positions[v + row] - grid->positions[v - row]);
                    EXPECT_LT(glm::distance(du, grid->dp_du[v]), tolerance * glm::length(du));
                    EXPECT_LT(glm::distance(dv, grid->dp_dv[v]), tolerance * glm::length(dv));
                    ++checked;
                }
        EXPECT_GT(checked, 1000);
    }
}

TEST(Subdivision, bounds_hold_every_descendant) {
    // A ring of semi-sharp edges bends the faces beside it within a narrow band.
    GeometryData creased = smooth_prism(1.5f, 1.0f);
    for (int i = 0; i < 5; ++i) {
        for (const int v : {i, (i + 1) % 5}) creased.subdivision.crease_verts.push_back(v);
        creased.subdivision.crease_values.push_back(2.7f);
    }
    for (const GeometryData& data :
         {smooth_cube(1.0f), smooth_tetrahedron(1.0f), smooth_prism(1.5f, 1.0f), creased}) {
        DiceScene s(data, 1.0f, 32);
        s.perspective(100.0);
        Mat4d m(1.0);
        m[3] = glm::dvec4(0.1, 0.2, 5.0, 1.0);
        s.scene.instances[0].world_from_object = {m};
        const auto opened = open_instance(s.view, 0, s.report);
        const auto inside = [](const RasterBounds& in, const RasterBounds& out) {
            // A 128th of a pixel is the rounding margin of both.
            const float e = 1.0f / 128.0f;
            EXPECT_GE(in.x0, out.x0 - e);
            EXPECT_GE(in.y0, out.y0 - e);
            EXPECT_LE(in.x1, out.x1 + e);
            EXPECT_LE(in.y1, out.y1 + e);
            EXPECT_LE(in.nearest_key, out.nearest_key * 1.0001f);
        };
        const std::function<void(const Primitive&, const std::vector<RasterBounds>&)> walk =
            [&](const Primitive& primitive, std::vector<RasterBounds> path) {
                path.push_back(primitive.bounds());
                if (primitive.diceable()) {
                    const auto grid = primitive.dice();
                    for (const RasterBounds& out : path) inside(grid->bounds, out);
                    return;
                }
                for (const auto& child : primitive.split()) walk(*child, path);
            };
        const RasterBounds whole = instance_bounds(s.view, 0);
        for (std::size_t i = 0; i < opened->primitive_count(); ++i)
            walk(*opened->primitive(i), {whole, opened->bounds(i)});
    }
}

TEST(Subdivision, a_nan_takes_its_neighbourhood_and_leaves_the_rest) {
    // A 6 x 6 sheet; the support of vertex (0, 0) are the faces that touch a face that touches it.
    std::vector<Vec3f> p;
    std::vector<std::int32_t> corners;
    for (int j = 0; j < 7; ++j)
        for (int i = 0; i < 7; ++i) p.emplace_back(8.0f * i, 8.0f * j, 0.0f);
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 6; ++i)
            for (const int v : {7 * j + i, 7 * j + i + 1, 7 * j + i + 8, 7 * j + i + 7})
                corners.push_back(v);
    GeometryData data = mesh(p, std::vector<std::int32_t>(36, 4), corners);
    data.is_subdivision = true;
    data.points[0].x = std::numeric_limits<float>::infinity();
    DiceScene s(data);
    double x0 = 1e9;
    for (const auto& grid : s.grids())
        for (const Vec3f& v : grid->positions) {
            ASSERT_TRUE(is_finite(v));
            if (v.y < 8.0f) x0 = std::min<double>(x0, v.x);
        }
    EXPECT_GT(x0, 15.9);
    ASSERT_EQ(s.report.warnings().size(), 1u);
    EXPECT_NE(s.report.warnings()[0].message.find("4 faces"), std::string::npos);
}

TEST(Subdivision, a_cage_that_cannot_be_subdivided_is_rendered_and_named) {
    // A vertex of 66,000 faces is beyond OpenSubdiv's limit of 65,535.
    const int n = 66000;
    std::vector<Vec3f> p{{0, 0, 0}};
    std::vector<std::int32_t> corners;
    for (int i = 0; i < n; ++i) {
        p.emplace_back(50 * std::cos(i * 2 * M_PI / n), 50 * std::sin(i * 2 * M_PI / n), 0.0f);
        for (const int v : {0, 1 + i, 1 + (i + 1) % n}) corners.push_back(v);
    }
    GeometryData data = mesh(p, std::vector<std::int32_t>(static_cast<std::size_t>(n), 3), corners);
    data.is_subdivision = true;
    DiceScene s(data, 8.0f);
    EXPECT_NEAR(area(s.grids()), M_PI * 2500, 1.0);
    ASSERT_EQ(s.report.warnings().size(), 1u);
    EXPECT_EQ(s.report.warnings()[0].datablock, "mesh 'Test'");
}

TEST(Subdivision, a_pole_of_many_faces_closes) {
    const int n = 60;
    std::vector<Vec3f> p{{0, 0, 20}, {0, 0, -20}};
    std::vector<std::int32_t> corners;
    for (int i = 0; i < n; ++i) {
        p.emplace_back(50 * std::cos(i * 2 * M_PI / n), 50 * std::sin(i * 2 * M_PI / n), 0.0f);
        for (const int v : {0, 2 + i, 2 + (i + 1) % n, 1, 2 + (i + 1) % n, 2 + i})
            corners.push_back(v);
    }
    GeometryData data = mesh(p, std::vector<std::int32_t>(2 * n, 3), corners);
    data.is_subdivision = true;
    DiceScene s(data);
    EXPECT_TRUE(open_edges(s.grids()).empty());
}

TEST(Subdivision, faces_that_name_a_vertex_twice_and_fins_do_no_harm) {
    GeometryData data = mesh({{0, 0, 0}, {30, 0, 0}, {30, 30, 0}, {0, 30, 0}, {15, 15, 30}},
                             {4, 4, 3, 3, 3}, {0, 1, 2, 3, 0, 1, 1, 4, 0, 1, 4, 0, 1, 4, 2, 2, 4});
    data.is_subdivision = true;
    DiceScene s(data);
    for (const auto& grid : s.grids())
        for (const auto* list : {&grid->positions, &grid->normal, &grid->dp_du, &grid->dp_dv})
            for (const Vec3f& v : *list) EXPECT_TRUE(is_finite(v));
}

}  // namespace
}  // namespace granita::testing
