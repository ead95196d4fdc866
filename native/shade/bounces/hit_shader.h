// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "scene/scene.h"
#include "shade/nodes/node_compiler.h"

namespace granita {

/// The materials of a frame as rays from other surfaces see them: a program for each type of ray
/// that a graph tells apart.
class HitShader {
  public:
    /// Scene and textures must outlive it.  `report` knows what the camera's programs have said
    /// and is told what is new.
    HitShader(const Scene& scene, TextureStore& textures, Report& report);

    /// -1: no material.
    const CompiledSurface& surface(std::int32_t material, RayType ray) const;

  private:
    void add(const NodeGraph& graph, const Scene& scene, TextureStore& textures, Report& report,
             const GraphOwner& owner);

    std::vector<CompiledSurface> m_surfaces;
    std::vector<std::array<std::size_t, kRayTypes>> m_of;  ///< [materials + 1][types of rays]
};

}  // namespace granita
