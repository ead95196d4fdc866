// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "scene/geometry_data.h"

namespace granita {

/// Unit normals of a mesh's vertices, weighted by the angle each face takes there, as Blender does
/// (Thuermer and Wuethrich 1998).  `points` [V] any space; a vertex without a face gets (0, 0, 0).
std::vector<Vec3f> vertex_normals(const GeometryData& data, std::span<const Vec3f> points);

}  // namespace granita
