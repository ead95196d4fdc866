// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry > Random Per Island: one number for what hangs together by edges.
#pragma once

#include <string>

#include "scene/geometry_data.h"

namespace granita {

/// No artist's attribute has this name: Blender's begin with a dot only where they are its own.
inline const std::string kIslandAttribute = ".random_per_island";

/// One number a face, 0 to 1.  `edges` [2 E] are pairs of vertices in Blender's order, which
/// decides what number an island has (the same as in Cycles: a hash of the vertex that its
/// union-find keeps).
Attribute random_per_island(const GeometryData& geometry, const std::vector<std::int32_t>& edges);

}  // namespace granita
