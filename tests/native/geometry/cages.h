// SPDX-License-Identifier: GPL-3.0-or-later
// Cages of subdivision surfaces, and places on their limits.
#pragma once

#include "geometry/surface_evaluator.h"

namespace granita {

/// Corners at +-1, six outward quads.
inline GeometryData cube_cage() {
    GeometryData data;
    data.name = "mesh 'Cube'";
    for (int i = 0; i < 8; ++i)
        data.points.emplace_back(i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f);
    data.face_sizes.assign(6, 4);
    data.corner_verts = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    data.is_subdivision = true;
    return data;
}

/// n x n quads, row by row; vertices at `place(i, j)`.
template <class Place>
GeometryData sheet_cage(int n, Place place) {
    GeometryData data;
    data.name = "mesh 'Sheet'";
    data.is_subdivision = true;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) data.points.push_back(place(i, j));
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int v = j * (n + 1) + i;
            for (const int c : {v, v + 1, v + n + 2, v + n + 1}) data.corner_verts.push_back(c);
            data.face_sizes.push_back(4);
        }
    return data;
}

/// Of a cage that stands still, object space.
struct LimitPoint {
    Vec3d p, normal;
};

inline LimitPoint limit_point(const SharedGeometry& shared, const BasePatch& patch,
                              const Vec2d& uv) {
    const int face = static_cast<int>(patch.face);
    const FaceCoordinates at(*shared.subdivision(), face);
    Vec3d p, du, dv;
    shared.surface().limit_face(face).evaluate(at.sub_face(static_cast<int>(patch.sub), uv), &p.x,
                                               &du.x, &dv.x);
    return {p, glm::normalize(glm::cross(du, dv))};
}

}  // namespace granita
