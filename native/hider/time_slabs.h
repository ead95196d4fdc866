// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "math/bounds.h"
#include "math/projection.h"

namespace granita {

/// Where a moving thing can be seen during a part of the shutter.
struct TimeSlab {
    float t0 = 0.0f, t1 = 1.0f;
    RasterBounds bounds;
};

/// How many slabs a path with so many knots, at least two, has: at least eight, none across a knot.
/// The bounds over the whole shutter hide nothing that moves fast; those of a slab do (space-time
/// occlusion culling: Boulos et al. 2010).
int slab_count(std::size_t knots);
/// One of them.  `boxes` [knots] camera space, between which everything moves linearly.
TimeSlab time_slab(std::span<const Bounds3f> boxes, int index, const Projection& projection);

}  // namespace granita
