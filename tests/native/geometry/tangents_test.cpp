// SPDX-License-Identifier: GPL-3.0-or-later
// Tangents of the corners of triangles: Mikkelsen's rules, one by one.
#include "geometry/tangents.h"

#include <gtest/gtest.h>

#include <cmath>

namespace granita {
namespace {

const Vec3f kUp(0, 0, 1);

/// A corner above the plane whose map is the plane itself.
TangentCorner flat(float x, float y) {
    return {{x, y, 0}, kUp, {x, y}};
}

void expect_near(const Vec4f& value, const Vec4f& expected) {
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(value[i], expected[i], 1e-6f) << i;
}

TEST(Tangents, run_along_growing_u_and_tell_mirrored_maps) {
    std::vector<TangentCorner> corners{flat(0, 0), flat(2, 0), flat(0, 1)};
    for (const Vec4f& tangent : tangents(corners)) expect_near(tangent, {1, 0, 0, 1});
    for (TangentCorner& corner : corners) corner.uv = {-corner.uv.x, corner.uv.y};
    for (const Vec4f& tangent : tangents(corners)) expect_near(tangent, {-1, 0, 0, -1});
    for (TangentCorner& corner : corners) corner.uv = {corner.uv.y, 3.0f * corner.uv.x};
    for (const Vec4f& tangent : tangents(corners)) expect_near(tangent, {0, 1, 0, 1});
}

TEST(Tangents, are_means_by_angle_of_the_triangles_at_a_corner) {
    // At the middle: a right angle whose map runs along x, half a right one where it runs along y.
    const TangentCorner middle = flat(0, 0);
    TangentCorner side = flat(0, 1), far = flat(-1, 1);
    side.uv = {0.0f, 1.0f};
    far.uv = {0.5f, 2.0f};
    const std::vector<TangentCorner> corners{middle, flat(1, 0), side, middle, side, far};
    const Vec2f to_side = side.uv, to_far = far.uv;
    const Vec3f along =
        glm::normalize((side.position * to_far.y - far.position * to_side.y) *
                       (to_side.x * to_far.y - to_side.y * to_far.x < 0 ? -1.0f : 1.0f));
    const std::vector<Vec4f> found = tangents(corners);
    ASSERT_LT(to_side.x * to_far.y - to_side.y * to_far.x, 0.0f);  // mirrored: a group of its own
    expect_near(found[0], {1, 0, 0, 1});
    expect_near(found[3], Vec4f(along, -1));
    // Of one sense they are one corner.
    TangentCorner turned = far;
    turned.uv = {-1.0f, 0.5f};
    const std::vector<TangentCorner> joined{middle, flat(1, 0), side, middle, side, turned};
    const Vec3f second = glm::normalize(side.position * turned.uv.y - turned.position * side.uv.y);
    const Vec3f mean = glm::normalize(2.0f * Vec3f(1, 0, 0) + second);
    expect_near(tangents(joined)[0], Vec4f(mean, 1));
    expect_near(tangents(joined)[3], Vec4f(mean, 1));
}

TEST(Tangents, are_orthogonal_to_the_corners_normals) {
    std::vector<TangentCorner> corners{flat(0, 0), flat(1, 0), flat(0, 1)};
    corners[1].normal = glm::normalize(Vec3f(0.6f, 0.0f, 0.8f));
    expect_near(tangents(corners)[1], {0.8f, 0, -0.6f, 1});
}

TEST(Tangents, do_not_run_over_seams) {
    // The same places, another part of the map.
    std::vector<TangentCorner> corners{flat(0, 0), flat(1, 0), flat(0, 1),
                                       flat(1, 0), flat(1, 1), flat(0, 1)};
    for (std::size_t i = 3; i < 6; ++i)
        corners[i].uv = Vec2f(5.0f - corners[i].uv.y, corners[i].uv.x);
    const std::vector<Vec4f> found = tangents(corners);
    for (std::size_t i = 0; i < 3; ++i) expect_near(found[i], {1, 0, 0, 1});
    for (std::size_t i = 3; i < 6; ++i) expect_near(found[i], {0, -1, 0, 1});
}

TEST(Tangents, of_what_has_no_area_come_from_beside_it) {
    // Without area in the map; without area in space; neither with anything beside it.
    TangentCorner stuck = flat(1, 1);
    stuck.uv = {1, 0};
    const std::vector<TangentCorner> corners{flat(0, 0), flat(1, 0), flat(0, 1),  //
                                             flat(1, 0), stuck,      flat(1, 0),  //
                                             flat(7, 7), flat(7, 7), flat(7, 7)};
    const std::vector<Vec4f> found = tangents(corners);
    expect_near(found[3], {1, 0, 0, 1});
    for (const Vec4f& tangent : found) EXPECT_NEAR(glm::length(Vec3f(tangent)), 1.0f, 1e-6f);
    EXPECT_TRUE(tangents({}).empty());
}

}  // namespace
}  // namespace granita
