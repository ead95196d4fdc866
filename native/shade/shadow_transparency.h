// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "shade/nodes/node_compiler.h"
#include "shade/rays/ray_materials.h"

namespace granita {

/// Tells rays what passes surfaces: what a material's opacity program says where they meet it, seen
/// along the ray, per channel in [0, 1].  Textures are read at full resolution.
/// @param surface a material as the camera sees it.
/// @param opacity what rays of a type ask of one.
void tell_transparency(
    RayMaterials& asked, const Scene& scene,
    const std::function<const CompiledSurface&(std::int32_t material)>& surface,
    std::function<const OpacityProgram&(std::int32_t material, RayType ray)> opacity);

}  // namespace granita
