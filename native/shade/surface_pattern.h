// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shade/lights/light_pattern.h"
#include "shade/nodes/material_emission.h"
#include "shade/rays/ray_scene.h"

namespace granita {

/// What surfaces send out by a program, where samples of them end.  All must outlive it.
std::shared_ptr<const LightPattern> surface_pattern(const EmissionProgram& program,
                                                    const Scene& scene, const RayScene& rays);

}  // namespace granita
