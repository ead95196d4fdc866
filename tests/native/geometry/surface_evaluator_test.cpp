// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface_evaluator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/report.h"
#include "geometry/cages.h"
#include "geometry/limit_vertices.h"

namespace granita {
namespace {

/// n x n quads, a metre each, z from `height(x, y)`.
template <class Height>
GeometryData sheet(int n, Height height) {
    return sheet_cage(n, [&](int i, int j) { return Vec3f(i, j, height(i, j)); });
}

TEST(SurfaceEvaluator, a_subdivision_surface_and_its_attributes_are_the_limits) {
    const GeometryData data = cube_cage();
    Report report;
    const SharedGeometry shared(data, 0.0f, report);
    const SurfaceEvaluator& surface = shared.surface();
    const Vec2d middle(0.5);
    std::vector<float> values, du, dv;
    for (const BasePatch& patch : shared.patches()) {
        // Of the +-1 cube's limit: 68/81 from the centre, inside of the cage's box of size 2.
        const LimitPoint at = limit_point(shared, patch, middle);
        EXPECT_NEAR(glm::length(at.p), 68.0 / 81.0, 1e-6);
        EXPECT_NEAR(glm::dot(at.normal, glm::normalize(at.p)), 1.0, 1e-9);
        surface.attribute(patch, {AttributeSource::ObjectPosition, "", 3, true}, {&middle, 1},
                          values, du, dv);
        surface.attribute(patch, {AttributeSource::Generated, "", 3, false}, {&middle, 1}, du, dv,
                          dv);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(values[static_cast<std::size_t>(c)], at.p[c], 1e-6);
            EXPECT_NEAR(du[static_cast<std::size_t>(c)], 0.5 + 0.5 * at.p[c], 1e-6);
        }
    }
}

TEST(LimitVertices, are_where_the_mask_of_catmull_and_clark_puts_them) {
    // Inside of a sheet of quads the limit is (16 v + 4 (edges) + (faces)) / 36 of its nine.
    const auto height = [](int i, int j) { return std::sin(1.3f * i) * std::cos(0.9f * j); };
    const GeometryData data = sheet(6, height);
    Report report;
    const SharedGeometry shared(data, 0.0f, report);
    const LimitVertices& limit = *shared.limit();
    ASSERT_EQ(limit.points.size(), data.points.size());
    for (int j = 1; j < 6; ++j)
        for (int i = 1; i < 6; ++i) {
            double sum = 0.0;
            Vec2d slope(0.0);
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x) {
                    const double z = height(i + x, j + y);
                    const double wx = x == 0 ? 4.0 : 1.0, wy = y == 0 ? 4.0 : 1.0;
                    sum += wx * wy * z / 36.0;
                    slope += Vec2d(x * wy, y * wx) * z / 12.0;
                }
            const auto v = static_cast<std::size_t>(j * 7 + i);
            EXPECT_NEAR(limit.points[v].z, sum, 1e-6);
            EXPECT_NEAR(limit.points[v].x, i, 1e-6);
            const Vec3d normal = glm::normalize(Vec3d(-slope, 1.0));
            EXPECT_NEAR(glm::distance(Vec3d(limit.normals[v]), normal), 0.0, 1e-6);
        }
}

TEST(LimitVertices, heights_hold_what_lies_between_the_corners_and_nothing_more_than_thrice_that) {
    const auto wave = [](int i, int j) { return 0.2f * std::sin(0.8f * i) * std::cos(0.6f * j); };
    const GeometryData data = sheet(8, wave);
    Report report;
    const SharedGeometry shared(data, 0.0f, report);
    double held = 0.0, found = 0.0;
    for (const BasePatch& patch : shared.patches()) {
        const Vec3f* const p = shared.limit()->points.data();
        Vec3d corner[4];
        for (int i = 0; i < 4; ++i) corner[i] = p[data.corner_verts[patch.corner[i]]];
        double most = 0.0;
        for (int j = 0; j <= 16; ++j)
            for (int i = 0; i <= 16; ++i) {
                const Vec2d uv = Vec2d(i, j) / 16.0;
                const Vec3d at = limit_point(shared, patch, uv).p;
                // x and y are the sheet's own inside of it: the triangles' height there.
                const double s = at.x - corner[0].x, t = at.y - corner[0].y;
                const double z = s > t ? corner[0].z + s * (corner[1].z - corner[0].z) +
                                             t * (corner[2].z - corner[1].z)
                                       : corner[0].z + t * (corner[3].z - corner[0].z) +
                                             s * (corner[2].z - corner[3].z);
                if (patch.face % 8 > 0 && patch.face % 8 < 7 && patch.face > 7 && patch.face < 56)
                    most = std::max(most, std::abs(at.z - z));
            }
        EXPECT_LE(most, shared.limit()->heights[patch.face] + 1e-6) << patch.face;
        held += shared.limit()->heights[patch.face];
        found += most;
    }
    EXPECT_LE(held, 3.0 * found);
    const GeometryData flat = sheet(4, [](int, int) { return 2.0f; });
    const SharedGeometry plane(flat, 0.0f, report);
    for (const float height : plane.limit()->heights) EXPECT_LE(height, 1e-6f);
}

}  // namespace
}  // namespace granita
