// SPDX-License-Identifier: GPL-3.0-or-later
// What of a picture the next one can use again, as far as geometry and rays are concerned; each
// part knows what it is made of.
#pragma once

#include <memory>

#include "geometry/persistent_geometry.h"
#include "shade/rays/persistent_rays.h"
#include "shade/shaded_grids.h"

namespace granita {

struct PersistentOffsets;  // shade/material_displacement.h

struct PersistentShading {
    std::shared_ptr<PersistentGeometry> geometry = std::make_shared<PersistentGeometry>();
    std::shared_ptr<PersistentRays> rays = std::make_shared<PersistentRays>();
    /// Of an earlier picture in which nothing that shading reads was another, but for grids
    /// themselves; may be nullptr.
    std::shared_ptr<const ShadedGrids> grids;
    /// Of an earlier picture with the same offsets, or nullptr.
    std::shared_ptr<PersistentOffsets> offsets;
};

}  // namespace granita
