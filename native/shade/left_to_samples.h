// SPDX-License-Identifier: GPL-3.0-or-later
// Of grass, leaves and small instances that hide each other a grid has more points than samples
// that see something of it.  Shading these samples by themselves then costs less, and is right:
// what would be interpolated from corners out of sight is gone.  The same holds where corners say
// little of what lies between them: of what is displaced so finely that normals turn from one
// micropolygon to the next.
#pragma once

#include "dice/grid.h"
#include "scene/scene.h"
#include "shade/bsdf/lobe.h"
#include "shade/lights/direct_light.h"

namespace granita {

/// Whether no point of a grid of a mesh is to be lit: each sample that sees it sends ways itself.
/// The same whatever bucket asks.
/// @param looked whether `points` of the grid were looked at (look_at()); if not, roughness tells.
bool pays_by_samples(const Grid& grid, const ShadingPoints& points, bool looked, const Scene& scene,
                     const DirectLight& light);

}  // namespace granita
