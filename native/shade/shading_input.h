// SPDX-License-Identifier: GPL-3.0-or-later
// What programs run over, of a grid.
#pragma once

#include "dice/grid.h"
#include "scene/scene.h"
#include "shade/programs/program.h"
#include "shade/refined_points.h"

namespace granita {

/// At `points` of the grid; `rays` that nodes may ask, or nullptr.
ShadingInput shading_input(const Grid& grid, const ShadingPoints& points, const Scene& scene,
                           const RayScene* rays, const Progress& progress);
/// Between its vertices.
ShadingInput shading_input(const Grid& grid, const RefinedPoints& refined, const Scene& scene,
                           const RayScene* rays, const Progress& progress);

}  // namespace granita
