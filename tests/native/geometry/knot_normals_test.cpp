// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/knot_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/shared_geometry.h"

namespace granita {
namespace {

/// Two squares that meet in the line x = 0 and lean by `slopes` from there, a knot each.
GeometryData tent(std::initializer_list<float> slopes) {
    GeometryData data;
    data.name = "mesh 'Tent'";
    data.knots = static_cast<int>(slopes.size());
    for (const float slope : slopes)
        for (const float y : {0.0f, 1.0f})
            for (const float x : {-1.0f, 0.0f, 1.0f})
                data.points.emplace_back(x, y, -slope * std::abs(x));
    data.face_sizes = {4, 4};
    data.corner_verts = {0, 1, 4, 3, 1, 2, 5, 4};
    return data;
}

/// Of the side at negative x where it leans by `slope`, and of the other.
Vec3f side(float slope, float x) {
    return glm::normalize(Vec3f(x * slope, 0.0f, 1.0f));
}

void expect_near(const Vec3f& a, const Vec3f& b) {
    EXPECT_NEAR(glm::distance(a, b), 0.0f, 1e-6f) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(KnotNormals, are_none_where_nothing_bends_or_faces_have_their_own) {
    Report report;
    GeometryData still = tent({0.5f, 0.5f});
    still.smooth = {1, 1};
    EXPECT_EQ(SharedGeometry(still, 0.0f, report).knot_normals(), nullptr);
    const GeometryData flat = tent({0.0f, 0.5f});
    EXPECT_EQ(SharedGeometry(flat, 0.0f, report).knot_normals(), nullptr);
}

TEST(KnotNormals, of_what_is_smooth_are_those_of_its_shape) {
    Report report;
    GeometryData data = tent({0.0f, 0.5f, 1.0f});
    data.smooth = {1, 1};
    const SharedGeometry geometry(data, 0.5f, report);
    const KnotNormals& normals = *geometry.knot_normals();
    ASSERT_EQ(normals.times().count(), 3u);
    const float slopes[] = {0.0f, 0.5f, 1.0f};
    for (std::size_t i = 0; i < 3; ++i) {
        expect_near(normals.of(0, i), side(slopes[i], -1.0f));
        expect_near(normals.of(1, i), Vec3f(0, 0, 1));
        expect_near(normals.of(5, i), side(slopes[i], 1.0f));
    }
}

TEST(KnotNormals, that_were_given_go_along_with_the_faces_that_share_them) {
    Report report;
    // Knots are at 0 and 1, the frame between them: the corners of the ridge have one normal, which
    // stays upright; those of the feet have their faces'.
    GeometryData data = tent({0.0f, 1.0f});
    const Vec3f up(0, 0, 1), left = side(0.25f, -1.0f), right = side(0.25f, 1.0f);
    data.corner_normals = {left, up, up, left, up, right, right, up};
    const SharedGeometry geometry(data, 0.25f, report);
    const KnotNormals& normals = *geometry.knot_normals();
    ASSERT_EQ(normals.times().count(), 3u);
    ASSERT_EQ(normals.times().frame_number(), 1u);
    for (std::size_t corner = 0; corner < 8; ++corner)
        EXPECT_EQ(normals.of(static_cast<std::uint32_t>(corner), std::size_t{1}),
                  data.corner_normals[corner]);
    for (const std::uint32_t ridge : {1u, 2u, 4u, 7u}) {
        expect_near(normals.of(ridge, std::size_t{0}), up);
        expect_near(normals.of(ridge, std::size_t{2}), up);
    }
    expect_near(normals.of(0, std::size_t{2}), side(1.0f, -1.0f));
    expect_near(normals.of(0, std::size_t{0}), up);
    // Said to be flat: though both sides are one plane at the frame.
    GeometryData folds = tent({0.0f, 1.0f});
    folds.smooth = {0, 0};
    folds.corner_normals.assign(8, up);
    const SharedGeometry folding(folds, 0.0f, report);
    expect_near(folding.knot_normals()->of(1, std::size_t{1}), side(1.0f, -1.0f));
    expect_near(folding.knot_normals()->of(4, std::size_t{1}), side(1.0f, 1.0f));
    // Sharp: each with its own face.
    data.corner_normals = {left, left, left, left, right, right, right, right};
    const SharedGeometry sharp(data, 0.25f, report);
    expect_near(sharp.knot_normals()->of(1, std::size_t{2}), side(1.0f, -1.0f));
    expect_near(sharp.knot_normals()->of(4, std::size_t{2}), side(1.0f, 1.0f));
}

TEST(KnotNormals, that_were_given_go_along_at_a_vertex_amid_an_edge) {
    Report report;
    GeometryData data;
    data.name = "mesh 'Leaf'";
    data.knots = 2;
    // A square with a vertex more in its lower edge, which turns by a right angle about y.
    const Vec3f square[] = {{0, 0, 0}, {0.4f, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    for (const Vec3f& p : square) data.points.push_back(p);
    for (const Vec3f& p : square) data.points.emplace_back(0.0f, p.y, -p.x);
    data.face_sizes = {5};
    data.corner_verts = {0, 1, 2, 3, 4};
    data.corner_normals.assign(5, Vec3f(0, 0, 1));
    const SharedGeometry geometry(data, 0.0f, report);
    for (std::uint32_t corner = 0; corner < 5; ++corner)
        expect_near(geometry.knot_normals()->of(corner, std::size_t{1}), Vec3f(1, 0, 0));
}

TEST(NormalTimes, have_the_frame_among_the_knots) {
    const NormalTimes times{3, {1, 0.25}};
    ASSERT_EQ(times.count(), 4u);
    EXPECT_EQ(times.at({0, 0.5}), (KnotTime{0, 0.5}));
    EXPECT_EQ(times.at({1, 0.0}), (KnotTime{1, 0.0}));
    EXPECT_EQ(times.at({1, 0.125}), (KnotTime{1, 0.5}));
    EXPECT_EQ(times.at({1, 0.25}), (KnotTime{2, 0.0}));
    EXPECT_EQ(times.at({1, 0.625}), (KnotTime{2, 0.5}));
    EXPECT_EQ(times.at({2, 0.0}), (KnotTime{3, 0.0}));
    const NormalTimes knots{3, {1, 0.0}};
    EXPECT_EQ(knots.count(), 3u);
    EXPECT_EQ(knots.at({1, 0.5}), (KnotTime{1, 0.5}));
}

}  // namespace
}  // namespace granita
