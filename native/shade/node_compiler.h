// SPDX-License-Identifier: GPL-3.0-or-later
// From a node graph to programs: opacity (only what feeds transparency) and radiance (design,
// decision 6).
#pragma once

#include <string>
#include <vector>

#include "shade/program.h"
#include "shade/surface_builder.h"

namespace granita {

struct SurfaceProgram {
    Program program;
    SurfaceSources sources;
};

struct CompiledSurface {
    std::vector<AttributeRequest> requests;
    Program opacity_program;
    VectorSource transparency;  ///< of opacity_program
    SurfaceProgram radiance;
};

/// Compiles `graph.surface`.  `owner` names the datablock in messages.
CompiledSurface compile_surface(const NodeGraph& graph, const Scene& scene, TextureStore& textures,
                                Report& report, const std::string& owner, bool is_world);

}  // namespace granita
