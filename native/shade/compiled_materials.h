// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "scene/channels.h"
#include "scene/scene.h"
#include "shade/material_displacement.h"
#include "shade/nodes/node_compiler.h"
#include "shade/textures/texture.h"

namespace granita {

/// Of all materials of a scene.
struct CompiledMaterials {
    std::vector<CompiledSurface> surfaces;  ///< [materials + 1], the last for "no material"
    std::vector<std::optional<DisplacementProgram>> displacements;  ///< [materials]
};

/// @param passes that surfaces are asked for, or nullptr.
CompiledMaterials compile_materials(const Scene& scene, TextureStore& textures, Report& report,
                                    const Progress& progress, const ChannelSet* passes);

}  // namespace granita
