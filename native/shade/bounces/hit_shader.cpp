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
    constexpr std::array kTypes{RayType::Diffuse, RayType::Glossy, RayType::Singular,
                                RayType::Transmission, RayType::Clear};
    for (std::size_t k = 0; k < kTypes.size(); ++k) {
        std::size_t same = 0;
        while (same < k && told_apart(graph, kTypes[same], kTypes[k])) ++same;
        const auto index = static_cast<std::size_t>(kTypes[k]);
        if (same < k) {
            of[index] = of[static_cast<std::size_t>(kTypes[same])];
            continue;
        }
        of[index] = m_surfaces.size();
        m_surfaces.push_back(
            compile_surface(graph, scene, textures, report, owner, nullptr, kTypes[k]));
        m_any_emits |= !m_surfaces.back().radiance.sources.emission.is(Vec3f(0.0f));
    }
}

const CompiledSurface& HitShader::surface(std::int32_t material, RayType ray) const {
    const auto& of = material < 0 ? m_of.back() : m_of[static_cast<std::size_t>(material)];
    return m_surfaces[of[static_cast<std::size_t>(ray)]];
}

}  // namespace granita
