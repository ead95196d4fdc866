// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dice/grid.h"
#include "math/projection.h"

namespace granita {

/// Leaves of a diced lattice's vertices about one a `rate` pixels to be shaded, if it has more
/// (Options::shading_rate); colours and opacities are interpolated between them.
void coarsen_shading(Grid& grid, const Projection& projection, double rate);

}  // namespace granita
