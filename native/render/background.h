// SPDX-License-Identifier: GPL-3.0-or-later
// The world behind the samples of a tile: it turns with the camera during the shutter and is
// defocused by the lens like everything at infinity.
#pragma once

#include <vector>

#include "hider/sample_store.h"
#include "hider/sample_table.h"
#include "scene/camera.h"
#include "shade/shading_system.h"

namespace granita {

/// Background radiance for composite_tile: one value where it does not vary over the tile or is not
/// seen, otherwise one a sample.
std::vector<Vec3f> tile_background(const Camera& camera, const SampleTable& table,
                                   const ShadingSystem& shading, const Vec3f& constant,
                                   const TileStore& store);

/// The world at the corners of pixels at one time and from one point of the unit lens,
/// [height + 1][width + 1]: within a pass of REGULAR sampling it is a smooth function of the pixel.
std::vector<Vec3f> corner_background(const Camera& camera, const ShadingSystem& shading,
                                     const Rect& pixels, double time, Vec2d lens);

}  // namespace granita
