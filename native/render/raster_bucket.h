// SPDX-License-Identifier: GPL-3.0-or-later
// One bucket on the raster executor, in the paper's order (9.3.3): what is seen, shading of
// that, drawing, filtering, all but the shading on the device.
#pragma once

#include "hider/raster/raster_hider.h"
#include "render/frame.h"

namespace granita {

/// The filter's weights, the sample lattice, the passes and what else a frame needs.
RasterFrame make_raster_frame(const Scene& scene, const Projection& projection,
                              const SampleTable& table, Statistics& statistics, Report& report,
                              const gl::ContextInfo& device);

/// The finished pixels of the bucket.  Throws Cancelled, GlError.
Tile raster_bucket(Frame& frame, int bucket);

}  // namespace granita
