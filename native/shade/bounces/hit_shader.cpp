// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/hit_shader.h"

#include "shade/nodes/default_material.h"

namespace granita {

HitShader::HitShader(const Scene& scene, TextureStore& textures, Report& report) {
    for (const Material& material : scene.materials)
        add(material.graph, scene, textures, report,
            {"material '" + material.name + "'", false, material.index});
    add(default_material(), scene, textures, report, {"no material"});
}

void HitShader::add(const NodeGraph& graph, const Scene& scene, TextureStore& textures,
                    Report& report, const GraphOwner& owner) {
    std::array<std::size_t, kRayTypes>& of = m_of.emplace_back();
    for (const RayType ray : kLightRays) {
        std::size_t& surface = of[static_cast<std::size_t>(ray)];
        const RayType alike = first_alike(graph, ray, kLightRays);
        if (alike != ray) {
            surface = of[static_cast<std::size_t>(alike)];
            continue;
        }
        surface = m_surfaces.size();
        Report warnings;
        m_surfaces.push_back(
            compile_surface(graph, scene, textures, warnings, owner, nullptr, ray));
        report.add_new(warnings);
    }
}

const CompiledSurface& HitShader::surface(std::int32_t material, RayType ray) const {
    const auto& of = material < 0 ? m_of.back() : m_of[static_cast<std::size_t>(material)];
    return m_surfaces[of[static_cast<std::size_t>(ray)]];
}

}  // namespace granita
