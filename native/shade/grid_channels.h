// SPDX-License-Identifier: GPL-3.0-or-later
// Writes what passes need to a grid's vertices (Grid::channels), where passes were asked for.
#pragma once

#include "scene/channels.h"
#include "scene/scene.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/reflection.h"
#include "shade/nodes/node_compiler.h"
#include "shade/shading_points.h"

namespace granita {

/// What shading a grid has left behind.
struct ShadedGrid {
    const ShadingPoints& points;
    const SurfaceClosure& closure;
    const ReflectionParts& parts;
    const Run& run;  ///< of the radiance program
    const PassSources& sources;
};

/// Fills Grid::channels by `channels`.
void fill_channels(Grid& grid, const ChannelSet& channels, const Scene& scene,
                   const ShadingCamera& camera, const ShadedGrid& shaded);

/// Quantity::Caught of a shadow catcher's radiance.  It is not composed in, and shows no light.
void fill_caught(Grid& grid, const ChannelSet& channels);

}  // namespace granita
