// SPDX-License-Identifier: GPL-3.0-or-later
// Where a camera-space box or a set of moving points can be seen, for every time and lens point.
#pragma once

#include <span>

#include "math/bounds.h"
#include "math/projection.h"

namespace granita {

/// Conservative for whatever moves inside `box`.  A side that the eye plane makes unbounded is
/// infinite; the others stay finite (a ground plane never rises over its horizon).
RasterBounds raster_bound(const Projection& projection, const Bounds3f& box);

/// Of all that goes from box to box.
RasterBounds raster_bound_of(const Projection& projection, std::span<const Bounds3f> boxes);

/// Conservative for everything in the convex hull of `points`: the projection through any one lens
/// point keeps lines straight.
RasterBounds raster_bound(const Projection& projection, std::span<const Vec3f> points);

}  // namespace granita
