// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/coincident_patches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace granita {
namespace {

using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// Faces of these corners.
CoincidentPatches of(std::vector<Vec3f> points, const std::vector<std::vector<int>>& faces) {
    GeometryData data;
    data.name = "mesh 'Faces'";
    data.points = std::move(points);
    for (const auto& face : faces) {
        data.face_sizes.push_back(static_cast<std::int32_t>(face.size()));
        data.corner_verts.insert(data.corner_verts.end(), face.begin(), face.end());
    }
    data.smooth.assign(faces.size(), 0);
    Report report;
    return CoincidentPatches(SharedGeometry(data, 0.5f, report));
}

const std::vector<Vec3f> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TEST(CoincidentPatches, faces_apart_have_no_others) {
    const CoincidentPatches none = of(kSquare, {{0, 1, 2}, {0, 2, 3}});
    EXPECT_TRUE(none.empty());
    EXPECT_THAT(none.of(0), IsEmpty());
}

TEST(CoincidentPatches, whichever_corner_comes_first_and_whichever_way_around) {
    std::vector<Vec3f> twice = kSquare;
    twice.insert(twice.end(), {{-0.0f, 1, 0}, {0, 0, -0.0f}, {1, 0, 0}, {1, 1, 0}, {5, 5, 5}});
    const CoincidentPatches found =
        of(twice, {{0, 1, 2, 3}, {5, 6, 7, 4}, {6, 7, 8}, {7, 6, 5, 4}, {0, 1, 2}, {0, 1, 3}});
    EXPECT_FALSE(found.empty());
    EXPECT_THAT(found.of(0), UnorderedElementsAre(0, 1, 3));
    EXPECT_THAT(found.of(3), UnorderedElementsAre(0, 1, 3));
    EXPECT_THAT(found.of(2), IsEmpty());
    EXPECT_THAT(found.of(4), IsEmpty());
}

}  // namespace
}  // namespace granita
