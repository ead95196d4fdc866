// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/compiled_materials.h"

#include "shade/nodes/default_material.h"

namespace granita {

CompiledMaterials compile_materials(const Scene& scene, TextureStore& textures, Report& report,
                                    const Progress& progress, const ChannelSet* passes) {
    CompiledMaterials compiled;
    for (const Material& material : scene.materials) {
        progress.check();
        const std::string owner = "material '" + material.name + "'";
        compiled.surfaces.push_back(compile_surface(material.graph, scene, textures, report,
                                                    {owner, false, material.index}, passes));
        std::optional<DisplacementProgram>& moved = compiled.displacements.emplace_back();
        if (material.graph.moves_surface())
            moved = compile_displacement(material.graph, scene, textures, report,
                                         {owner, false, material.index});
    }
    compiled.surfaces.push_back(
        compile_surface(default_material(), scene, textures, report, {"no material"}, passes));
    return compiled;
}

}  // namespace granita
