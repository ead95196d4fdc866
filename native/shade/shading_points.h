// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dice/grid.h"
#include "shade/bsdf/lobe.h"
#include "shade/programs/shading_camera.h"

namespace granita {

/// A grid's shading points in shading space.
ShadingPoints shading_points(const Grid& grid, const ShadingCamera& camera);

}  // namespace granita
