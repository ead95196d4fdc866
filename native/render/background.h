// SPDX-License-Identifier: GPL-3.0-or-later
// The world behind the samples of a tile: it turns with the camera during the shutter and is
// defocused by the lens like everything at infinity.
#pragma once

#include <functional>
#include <vector>

#include "hider/sample_store.h"
#include "hider/samples/sample_table.h"
#include "scene/camera.h"
#include "shade/shading_system.h"

namespace granita {

struct RasterPass;

/// Background radiance for composite_tile: one value where it does not vary over the tile or is not
/// seen, otherwise one a sample.
/// @param shows whether samples that see something show it; empty: none does.
std::vector<Vec3f> tile_background(const Camera& camera, const SampleTable& table,
                                   const ShadingSystem& shading, const Vec3f& constant,
                                   const TileStore& store,
                                   const std::function<bool(SurfaceId)>& shows);

/// The world at the corners of pixels in one pass of REGULAR sampling, within which it is a smooth
/// function of the pixel: [height + 1][width + 1].
std::vector<Vec3f> corner_background(const Camera& camera, const ShadingSystem& shading,
                                     const Rect& pixels, const RasterPass& pass);

}  // namespace granita
