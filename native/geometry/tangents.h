// SPDX-License-Identifier: GPL-3.0-or-later
// Tangent space as Blender and Cycles bake and read normal maps in it: Mikkelsen 2008, "Simulation
// of Wrinkled Surfaces Revisited" (the method known as MikkTSpace).
#pragma once

#include <span>
#include <vector>

#include "math/vec.h"

namespace granita {

/// A corner of a triangle; corners that are equal are one.
struct TangentCorner {
    Vec3f position{0.0f}, normal{0.0f};  ///< object space; unit
    Vec2f uv{0.0f};
    bool operator==(const TangentCorner&) const = default;
};

/// Unit tangents along growing u, orthogonal to the corners' normals: the mean, by angle, of those
/// of the triangles around a corner that share edges and the sense of their map.
/// @param corners three a triangle, finite.
/// @return [corners] xyz; w = 1, or -1 where the map is mirrored: the bitangent is
///         w * cross(normal, tangent).
std::vector<Vec4f> tangents(std::span<const TangentCorner> corners);

}  // namespace granita
