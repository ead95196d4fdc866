// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/limit_face.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/report.h"
#include "geometry/cages.h"

namespace granita {
namespace {

struct Opened {
    explicit Opened(const GeometryData& data) : shared(data, 0.5f, report) {}
    LimitFace face(int index) {
        LimitFace face;
        const Vec3f* points = shared.frame_points().data();
        EXPECT_TRUE(face.gather(*shared.subdivision(), index, {&points, 1}));
        return face;
    }
    Report report;
    SharedGeometry shared;
};

TEST(LimitFace, cube_corner_and_face_centre) {
    // Hard case 54: the face centre of the +-1 cube's limit is 68/81, its corner (.5, .5, .5).
    const GeometryData data = cube_cage();
    Opened opened(data);
    for (int f = 0; f < 6; ++f) {
        const LimitFace face = opened.face(f);
        Vec3d p, du, dv;
        // The irregular patches are approximated there to two levels: exact at neither, both within
        // the tolerance below (measured 2e-7 with OpenSubdiv 3.5.0).
        face.evaluate({0.5, 0.5}, &p.x, &du.x, &dv.x);
        EXPECT_NEAR(glm::length(p), 68.0 / 81.0, 1e-6);
        EXPECT_NEAR(glm::dot(glm::normalize(p), glm::normalize(glm::cross(du, dv))), 1.0, 1e-9);
        for (int c = 0; c < 4; ++c) {
            const FaceCoordinates at(*opened.shared.subdivision(), f);
            face.evaluate(at.vertex(c), &p.x);
            const Vec3f corner = data.points[static_cast<std::size_t>(
                data.corner_verts[static_cast<std::size_t>(4 * f + c)])];
            EXPECT_NEAR(glm::distance(p, 0.5 * Vec3d(corner)), 0.0, 1e-6);
        }
    }
}

TEST(LimitFace, sub_faces_of_an_n_gon_are_laid_out_as_stated) {
    // A pentagon: sub-face i has its corner at (0,0), edge middles at (1,0) and (0,1), the centre
    // at (1,1).
    GeometryData data;
    data.name = "mesh 'Pentagon'";
    for (int i = 0; i < 5; ++i)
        data.points.emplace_back(std::cos(i * 2 * M_PI / 5), std::sin(i * 2 * M_PI / 5), 0.0f);
    data.face_sizes = {5};
    data.corner_verts = {0, 1, 2, 3, 4};
    data.is_subdivision = true;
    data.subdivision.scheme = SubdivisionScheme::Simple;
    Opened opened(data);
    const LimitFace face = opened.face(0);
    const FaceCoordinates at(*opened.shared.subdivision(), 0);
    const auto place = [&](int sub, Vec2d uv) {
        Vec3d p;
        face.evaluate(at.sub_face(sub, uv), &p.x);
        return p;
    };
    for (int i = 0; i < 5; ++i) {
        const Vec3d here(data.points[static_cast<std::size_t>(i)]),
            next(data.points[static_cast<std::size_t>((i + 1) % 5)]),
            last(data.points[static_cast<std::size_t>((i + 4) % 5)]);
        EXPECT_NEAR(glm::distance(place(i, {0, 0}), here), 0.0, 1e-7);
        EXPECT_NEAR(glm::distance(place(i, {1, 0}), 0.5 * (here + next)), 0.0, 1e-7);
        EXPECT_NEAR(glm::distance(place(i, {0, 1}), 0.5 * (here + last)), 0.0, 1e-7);
        EXPECT_NEAR(glm::length(place(i, {1, 1})), 0.0, 1e-7);
    }
}

TEST(LimitFace, infinitely_sharp_edges_keep_the_polyhedron) {
    GeometryData data = cube_cage();
    for (int a = 0; a < 8; ++a)
        for (int bit : {1, 2, 4})
            if (!(a & bit)) {
                data.subdivision.crease_verts.insert(data.subdivision.crease_verts.end(),
                                                     {a, a | bit});
                data.subdivision.crease_values.push_back(10.0f);
            }
    Opened opened(data);
    for (int f = 0; f < 6; ++f) {
        const LimitFace face = opened.face(f);
        for (double u : {0.0, 0.21, 0.5, 1.0})
            for (double v : {0.0, 0.4, 1.0}) {
                Vec3d p;
                face.evaluate({u, v}, &p.x);
                EXPECT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1.0, 1e-6);
            }
    }
}

TEST(LimitFace, boundary_rule_decides_the_corner_of_a_sheet) {
    GeometryData data;
    data.name = "mesh 'Sheet'";
    data.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    data.face_sizes = {4};
    data.corner_verts = {0, 1, 2, 3};
    data.is_subdivision = true;
    for (const auto& [rule, expected] : {std::pair{SubdivisionBoundary::EdgeOnly, 1.0 / 6.0},
                                         std::pair{SubdivisionBoundary::EdgeAndCorner, 0.0}}) {
        data.subdivision.boundary = rule;
        Opened opened(data);
        Vec3d p;
        opened.face(0).evaluate({0.0, 0.0}, &p.x);
        // Edge only: the end of a uniform cubic B-spline through 1/6, 4/6, 1/6 of its neighbours.
        EXPECT_NEAR(p.x, expected, 1e-6);
        EXPECT_NEAR(p.y, expected, 1e-6);
    }
}

TEST(SubdivisionTopology, uv_seams_part_values_only_where_they_differ) {
    GeometryData data;
    data.name = "mesh 'Strip'";
    data.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
    data.face_sizes = {4, 4};
    data.corner_verts = {0, 1, 4, 3, 1, 2, 5, 4};
    data.is_subdivision = true;
    Attribute uv;
    uv.name = "UVMap";
    uv.kind = AttributeKind::Uv;
    uv.domain = Domain::Corner;
    uv.width = 2;
    // The upper vertex between the faces has two places in the map, which differ in u or in v.
    for (const Vec2f& other : {Vec2f(.7f, 1), Vec2f(.5f, .7f)}) {
        uv.values = {0, 0, .5f, 0, .5f, 1, 0, 1, .5f, 0, 1, 0, 1, 1, other.x, other.y};
        data.attributes = {uv};
        Opened opened(data);
        EXPECT_EQ(opened.shared.subdivision()->uv_channel(0), 0);
        EXPECT_EQ(opened.shared.subdivision()->uv_values(0).size() / 2, 7u);
    }
}

}  // namespace
}  // namespace granita
