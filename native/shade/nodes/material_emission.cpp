// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/material_emission.h"

#include <array>
#include <limits>
#include <optional>

#include "math/luminance.h"
#include "shade/rays/ray_type.h"

namespace granita {
namespace {

const VectorSource& emission(const CompiledSurface& surface) {
    return surface.radiance.sources.emission;
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

MaterialEmission::MaterialEmission(const Scene& scene, TextureStore& textures,
                                   const std::vector<CompiledSurface>& seen)
    : m_constant(scene.materials.size(), Vec3f(0.0f)), m_brightest(scene.materials.size(), 0.0f) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        std::optional<Vec3f> constant;
        bool varies = false;
        for (const RayType ray : kLightRays) {
            if (first_alike(material.graph, ray, kLightRays) != ray) continue;
            std::optional<CompiledSurface> own;
            Report said_already;
            if (first_alike(material.graph, ray, std::array{RayType::Camera, ray}) == ray)
                own = compile_surface(material.graph, scene, textures, said_already,
                                      {"material '" + material.name + "'", false, material.index},
                                      nullptr, ray);
            const VectorSource& sent = emission(own ? *own : seen[i]);
            const float seen_of_it = sent.is_constant() ? luminance(sent.constant) : kInfinity;
            if (!(seen_of_it <= m_brightest[i])) m_brightest[i] = seen_of_it;
            varies =
                varies || !sent.is_constant() || sent.constant != constant.value_or(sent.constant);
            constant = sent.constant;
        }
        if (!varies && constant && is_finite(*constant) && mean_size(*constant) > 0.0f)
            m_constant[i] = *constant;
    }
}

}  // namespace granita
