// SPDX-License-Identifier: GPL-3.0-or-later
// One bucket on the raster executor, in the paper's order (9.3.3): occlusion queries, shading of
// what is seen, drawing, filtering, all but the shading on the device.
#pragma once

#include "hider/raster_hider.h"
#include "render/frame.h"

namespace granita {

/// The filter's weights, the sample lattice and the background of a frame.
RasterFrame make_raster_frame(const Scene& scene, const Projection& projection,
                              const SampleTable& table, const Vec3f& background,
                              Statistics& statistics);

/// The finished pixels of the bucket.  Throws Cancelled, GlError.
Tile raster_bucket(Frame& frame, int bucket);

}  // namespace granita
