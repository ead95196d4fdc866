// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/smooth_rise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace granita {
namespace {

constexpr double kRadius = 3.0, kHalfAngle = 0.4;

struct Face {
    Vec3d p[4], normal[4];
};

/// Two triangles of a strip around a tube: corners 0 and 3, 1 and 2 on a circle each.
Face strip(double bend) {
    Face face;
    const double x = kRadius * std::sin(kHalfAngle), z = kRadius * std::cos(kHalfAngle);
    const Vec3d left(-std::sin(bend), 0.0, std::cos(bend)), right(-left.x, 0.0, left.z);
    const Vec3d corners[4] = {{-x, 0.0, z}, {-x, 9.0, z}, {x, 9.0, z}, {x, 0.0, z}};
    const Vec3d normals[4] = {left, left, right, right};
    for (int i = 0; i < 4; ++i) face.p[i] = corners[i], face.normal[i] = normals[i];
    return face;
}

CornerWeights at(double u, double v) {
    return {PatchKind::TrianglePair, {u, v}};
}

Vec3f rise_of(const Face& face, const CornerWeights& weights, bool above) {
    return smooth_rise(face.p, face.normal, weights, above);
}

TEST(SmoothRise, ReachesTheTubeThatNormalsTellOf) {
    const Face face = strip(kHalfAngle);
    // In the middle of corners 0 and 3: both tangent planes are r sin^2 a above it, the tube itself
    // r - r cos a.  The mean of the normals is cos a long.
    const Vec3f rise = rise_of(face, at(0.0, 0.5), true);
    const double plane = kRadius * std::sin(kHalfAngle) * std::sin(kHalfAngle);
    EXPECT_NEAR(rise.x, 0.0, 1e-6);
    EXPECT_NEAR(rise.y, 0.0, 1e-6);
    EXPECT_NEAR(rise.z, plane * std::cos(kHalfAngle), 1e-6);
    EXPECT_GT(rise.z, kRadius * (1.0 - std::cos(kHalfAngle)));
}

TEST(SmoothRise, IsNothingAtCornersAndWhereNormalsAreTheFaces) {
    for (const double u : {0.0, 1.0})
        for (const double v : {0.0, 1.0})
            for (const bool above : {false, true})
                EXPECT_NEAR(glm::length(rise_of(strip(kHalfAngle), at(u, v), above)), 0.0f, 1e-6f);
    const Face flat = strip(0.0);
    EXPECT_NEAR(glm::length(rise_of(flat, at(0.3, 0.6), true)), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::length(rise_of(flat, at(0.6, 0.3), false)), 0.0f, 1e-6f);
}

/// From inside it stands on the other side.
TEST(SmoothRise, TurnsWithTheSideThatIsSeen) {
    const Face face = strip(kHalfAngle);
    for (const Vec2d place : {Vec2d(0.2, 0.5), Vec2d(0.7, 0.4)}) {
        EXPECT_GT(rise_of(face, at(place.x, place.y), true).z, 0.1f);
        EXPECT_LT(rise_of(face, at(place.x, place.y), false).z, 0.0f);
    }
}

}  // namespace
}  // namespace granita
