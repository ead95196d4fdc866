// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/vertex_normals.h"

#include <gtest/gtest.h>

#include <cmath>

namespace granita {
namespace {

TEST(VertexNormals, do_not_depend_on_where_faces_are_cut) {
    // A cube's corner at the origin: three right angles, two of which are cut at that corner, one
    // in three.  The sums of angles stay, so the normal stays on the diagonal.
    GeometryData data;
    data.name = "mesh 'Corner'";
    data.points = {{0, 0, 0}, {1, 0, 0},       {0, 1, 0}, {0, 0, 1},
                   {1, 1, 0}, {.25f, .75f, 0}, {0, 1, 1}};
    data.face_sizes = {3, 3, 3, 3, 3, 3};
    data.corner_verts = {0, 1, 4, 0, 4, 5, 0, 5, 2, 0, 2, 6, 0, 6, 3, 0, 3, 1};
    const Vec3f normal = vertex_normals(data, data.points)[0];
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(normal[c], 1.0 / std::sqrt(3.0), 1e-6) << c;
}

TEST(VertexNormals, leave_out_faces_that_are_not_finite_and_vertices_without_any) {
    GeometryData data;
    data.name = "mesh 'Broken'";
    data.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}, {5, 5, 5}};
    data.face_sizes = {3, 3};
    data.corner_verts = {0, 1, 2, 0, 2, 3};
    const std::vector<Vec3f> normals = vertex_normals(data, data.points);
    EXPECT_EQ(normals[0], Vec3f(0, 0, 1));
    EXPECT_EQ(normals[4], Vec3f(0, 0, 0));
}

}  // namespace
}  // namespace granita
