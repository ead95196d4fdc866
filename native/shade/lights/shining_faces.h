// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that shine, as lamps: each triangle that rays meet of them is one.
#pragma once

#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "scene/scene.h"
#include "shade/lights/light_lamp.h"
#include "shade/rays/ray_scene.h"

namespace granita {

struct ShiningFaces {
    std::vector<Lamp> lamps;
    std::vector<bool> instances;  ///< [instances] which are among them
};

/// Of materials that RayMaterials::emitted tells, as far as there are not too many.  What is left
/// out, strands and points too, is met by chance, and named where nothing bounces.  Throws
/// Cancelled.
ShiningFaces shining_faces(const Scene& scene, const RayScene& rays, const RayMaterials& materials,
                           Report& report, const Progress& progress);

}  // namespace granita
