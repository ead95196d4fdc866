// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "dice/primitive.h"
#include "dice/view.h"

namespace granita {

/// [knots] camera-space boxes of an instance from its geometry's object-space boxes, without
/// opening it; empty where a transform is not finite.
std::vector<Bounds3f> instance_boxes(const View& view, std::size_t instance);
/// All of them in the raster.
RasterBounds instance_bounds(const View& view, std::size_t instance);

/// Transforms the geometry into camera space at its knots (composed in double, rounded once a
/// vertex: decision 9) and prepares its primitives.  Faces with non-finite or degenerate data are
/// left out and reported.
std::shared_ptr<const OpenedInstance> open_instance(const View& view, std::size_t instance,
                                                    Report& report);

}  // namespace granita
