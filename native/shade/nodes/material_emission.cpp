// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/material_emission.h"

#include <algorithm>
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
/// Radiance of a surface that nobody misses as a light: an 8-bit step of white.
constexpr float kDimmestEmission = 0.004f;

}  // namespace

MaterialEmission::MaterialEmission(const Scene& scene, TextureStore& textures,
                                   const std::vector<CompiledSurface>& seen)
    : m_constant(scene.materials.size(), Vec3f(0.0f)),
      m_programs(scene.materials.size()),
      m_brightest(scene.materials.size(), 0.0f) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        std::optional<Vec3f> constant;
        bool varies = false;
        std::optional<EmissionProgram> program;
        for (const RayType ray : kLightRays) {
            if (first_alike(material.graph, ray, kLightRays) != ray) continue;
            std::optional<CompiledSurface> own;
            Report said_already;
            if (first_alike(material.graph, ray, std::array{RayType::Camera, ray}) == ray)
                own = compile_surface(material.graph, scene, textures, said_already,
                                      {"material '" + material.name + "'", false, material.index},
                                      nullptr, ray);
            const CompiledSurface& surface = own ? *own : seen[i];
            const VectorSource& sent = emission(surface);
            // Where rays are told apart, there are several.
            const bool is_only = ray == kLightRays.front();
            program.reset();
            if (is_only && !sent.is_constant())
                program = {surface.requests, surface.radiance.program.part({sent.slot}), sent};
            // Where ways differ, samples of a lamp do not know whose they are.
            if (program && program->program.counts() && scene.options.bounces.most > 0)
                program.reset();
            const float seen_of_it = sent.is_constant() ? luminance(sent.constant) : kInfinity;
            if (!(seen_of_it <= m_brightest[i])) m_brightest[i] = seen_of_it;
            varies =
                varies || !sent.is_constant() || sent.constant != constant.value_or(sent.constant);
            constant = sent.constant;
        }
        if (!varies && constant && is_finite(*constant) && mean_size(*constant) > 0.0f)
            m_constant[i] = *constant;
        m_programs[i] = std::move(program);
    }
}

void MaterialEmission::warn(const Scene& scene, Report& report) const {
    const auto is_no_lamp = [this](std::int32_t material) {
        return !is_lamp(material) && brightest(material) >= kDimmestEmission;
    };
    if (scene.options.bounces.most > 0) {
        for (const Instance& instance : scene.instances)
            if (instance.blocker_set >= 0 && std::ranges::any_of(instance.materials, is_no_lamp))
                report.warn(instance.name,
                            "its emission varies by kind of ray or by depth, so that what blocks "
                            "its light is not linked");
        return;
    }
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
        if (is_no_lamp(static_cast<std::int32_t>(i)))
            report.warn("material '" + scene.materials[i].name + "'",
                        "its emission varies by kind of ray: it lights nothing without bounces");
}

}  // namespace granita
