// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "dice/grid.h"
#include "math/projection.h"

namespace granita {

/// Where a moving thing can be seen during a part of the shutter.
struct TimeSlab {
    float t0 = 0.0f, t1 = 1.0f;
    RasterBounds bounds;
};

/// Bounds of a moving grid over slabs of the shutter, at least eight and never across a knot.  The
/// bounds over the whole shutter hide nothing that moves fast; those of a slab do (space-time
/// occlusion culling: Boulos et al. 2010).
std::vector<TimeSlab> time_slabs(const Grid& grid, const Projection& projection);

}  // namespace granita
