// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon in space as triangles: ears are cut on its best-fit plane, so that concave polygons are
// filled exactly once (Meisters 1975).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "math/vec.h"

namespace granita {

struct Triangulation {
    /// Corner numbers of the polygon, counter-clockwise as the polygon; always n - 2 of them.
    std::vector<std::array<int, 3>> triangles;
    /// False: the polygon crosses itself or has no area; the triangles are then a fan.
    bool simple = true;
};

/// Twice the area times the unit normal of a closed polygon, planar or not (Newell's sum).
Vec3d newell_normal(std::span<const Vec3f> polygon);

/// Blender's two triangles of a quad: (start, start + 1, start + 2) and (start, start + 2,
/// start + 3), modulo 4.
struct QuadTriangles {
    int start = 0;        ///< 1 where a cut from corner 0 to 2 would turn one of them over
    double cosine = 1.0;  ///< between their normals; 1 where one has no area
};
/// `by_normal`: a triangle is turned over where it faces away from the quad's normal (as a rule
/// until Blender 4.0, whose meshes had normals when they were cut), else where it faces away from
/// the other one: of quads that are folded by more than a right angle they differ.
QuadTriangles triangulate_quad(std::span<const Vec3f, 4> quad, bool by_normal);

/// `polygon` has n >= 3 finite corners.
Triangulation triangulate(std::span<const Vec3f> polygon);

}  // namespace granita
