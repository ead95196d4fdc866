// SPDX-License-Identifier: GPL-3.0-or-later
// Where a bucket's grids are in the buffers; native/hider/raster/raster_geometry.h.
#include "shared/raster_layout.h"

struct GridPlace {
    uint vertex;       // its first
    uint position;     // its first
    uint vertices;     // of a knot
    uint knots;
    float open, close; // it exists at times of [open, close)
};
layout(std430, binding = RASTER_GRIDS) readonly buffer Grids { GridPlace grids[]; };
