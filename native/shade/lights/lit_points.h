// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "dice/grid.h"
#include "shade/bsdf/lobe.h"
#include "shade/lights/lamp_set.h"
#include "shade/lights/lit_grid.h"
#include "shade/lights/lit_point.h"

namespace granita {

/// Points of one mask together (Instance::receives).
using LitSets = std::map<std::uint64_t, std::vector<LitPoint>>;

/// Those whose lobes reflect, which keep `paths`.  Fills the colors of the grid's parts, where they
/// are asked for.
/// @param is_dark nothing else is.
LitSets lit_points(const LampSet& set, LitGrid& grid, const ShadingPoints& points,
                   const SurfaceClosure& closure, const GridKey& key, const PointPaths& paths,
                   bool is_dark);

}  // namespace granita
