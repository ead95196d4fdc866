// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace granita {

/// What drawing grids leaves behind: OUTPUT of shaders/raster/grid_output.glsl.
enum class RasterOutput { Surface, Radiance, Layer, Mark, LayerName, LayerRadiance, LayerOpacity };

}  // namespace granita
