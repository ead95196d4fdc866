// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shade/nodes/node_compiler.h"
#include "shade/rays/ray_materials.h"

namespace granita {

/// Runs a material's opacity program where a shadow ray meets it, seen along the ray: what passes,
/// per channel in [0, 1].  Textures are read at full resolution.
Vec3f shadow_transparency(const OpacityProgram& material, const Scene& scene, const RayHit& hit);

/// The same where it is one everywhere.
std::optional<Vec3f> constant_transparency(const OpacityProgram& material);

}  // namespace granita
