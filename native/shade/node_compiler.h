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

/// Whose graph it is.
struct GraphOwner {
    std::string name;  ///< for messages: "material 'Wood'"
    bool is_world = false;
    int material_index = 0;  ///< pass_index
};

/// Compiles `graph.surface`.  The scene, textures and report must outlive the programs.
CompiledSurface compile_surface(const NodeGraph& graph, const Scene& scene, TextureStore& textures,
                                Report& report, const GraphOwner& owner);

}  // namespace granita
