// SPDX-License-Identifier: GPL-3.0-or-later
// What of a picture the next one can use again, as far as geometry and rays are concerned; each
// part knows what it is made of.
#pragma once

#include <memory>

#include "geometry/kept_geometry.h"
#include "shade/rays/kept_rays.h"
#include "shade/shaded_grids.h"

namespace granita {

struct KeptOffsets;  // shade/material_displacement.h

struct KeptShading {
    std::shared_ptr<KeptGeometry> geometry = std::make_shared<KeptGeometry>();
    std::shared_ptr<KeptRays> rays = std::make_shared<KeptRays>();
    /// Of an earlier picture in which nothing that shading reads was another, but for grids
    /// themselves; may be nullptr.
    std::shared_ptr<const ShadedGrids> grids;
    /// Of an earlier picture with the same offsets, or nullptr.
    std::shared_ptr<KeptOffsets> offsets;
};

}  // namespace granita
