// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/frame_shading.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/stage_timer.h"
#include "shade/bounces/meets_light.h"
#include "shade/compiled_materials.h"
#include "shade/lamp_shader.h"
#include "shade/shadow_transparency.h"
#include "shade/surface_pattern.h"

namespace granita {

FrameShading::FrameShading(const Scene& s, Statistics& stats, Report& warnings, const Progress& p,
                           bool refines_samples, const PersistentShading& kept)
    : scene(s),
      statistics(stats),
      report(warnings),
      progress(p),
      textures(s, stats, report, &p),
      camera(s),
      eye(s, camera),
      shutter(s.options.shutter_curve),
      channels(s.options),
      world(s, textures, report),
      refines(refines_samples && s.options.refine_samples),
      moves(s.moves()),
      thresholds(s.options, moves),
      footprint(1.0f / std::sqrt(static_cast<float>(s.options.samples))),
      geometries(std::make_shared<GeometryCache>(kept.geometry)),
      shaded(kept.grids) {
    const StageTimer timer(stats, Stage::Shade);
    if (scene.has_shadow_catchers())
        catchers = std::make_unique<ShadowCatchers>(scene, stats, progress);
    const ChannelSet* passes = channels.empty() ? nullptr : &channels;
    CompiledMaterials compiled = compile_materials(scene, textures, report, progress, passes);
    materials = std::move(compiled.surfaces);
    for (const CompiledSurface& material : materials) requests.push_back(material.requests);
    displacement = std::make_unique<MaterialDisplacement>(scene, std::move(compiled.displacements),
                                                          geometries, report, kept.offsets);
    if (!displacement->any()) displacement.reset();
    emission = std::make_unique<MaterialEmission>(scene, textures, materials);
    const bool any_reflects = std::ranges::any_of(scene.instances, [this](const Instance& i) {
        if (!i.visible_camera) return false;
        const auto shows = [this](int index) { return reflects(index); };
        return i.materials.empty() ? shows(-1) : std::ranges::any_of(i.materials, shows);
    });
    const bool nodes_ask_rays = std::ranges::any_of(scene.materials, asks_rays, &Material::graph);
    if (Volumes::any(scene)) volumes = std::make_unique<Volumes>(scene, textures, report);
    if (!any_reflects && !volumes && !nodes_ask_rays) return;
    const auto of_surface = [this](std::int32_t index, const RayScene& rays) {
        return surface_pattern(*emission->program(index), scene, rays);
    };
    light = std::make_unique<DirectLight>(
        scene, world.evaluator(), statistics, report, progress, ray_materials(), geometries,
        kept.rays, displacement.get(),
        LightPatterns{lamp_patterns(scene, textures, report), of_surface}, nodes_ask_rays);
    emission->warn(scene, report);
    if (!light->rays()) return;
    const bool follows = meets_light(scene, light->lamp_faces(), *emission);
    if (follows || any([this](std::int32_t index) { return material(index).is_told_apart; }))
        hits = std::make_unique<HitShader>(scene, textures, report);
    HitScattering scatter;
    if (any([this](std::int32_t index) { return scatters(index); })) {
        const auto bent = [this](std::int32_t index) {
            const SurfaceProgram& radiance = material(index).radiance;
            return radiance.bends_scattered() ? &material(index) : nullptr;
        };
        below = std::make_unique<SubsurfaceLight>(scene, *light, bent, progress);
        scatter = std::bind_front(&SubsurfaceLight::scatter, below.get());
    }
    if (follows)
        bounces = std::make_unique<BouncedLight>(scene, *light, *hits, *emission, volumes.get(),
                                                 std::move(scatter), statistics, progress);
    if (volumes)
        seen_volumes = std::make_unique<SeenVolumes>(scene, *volumes, *light, bounces.get());
}

void FrameShading::warn_of_broken(std::int32_t index, std::size_t count) const {
    if (count == 0) return;
    const std::string owner =
        index < 0 ? "no material"
                  : "material '" + scene.materials[static_cast<std::size_t>(index)].name + "'";
    report.warn(owner, "is not finite at some points, where it is left out", count);
}

RayMaterials FrameShading::ray_materials() const {
    RayMaterials asked;
    tell_transparency(
        asked, scene,
        [this](std::int32_t index) -> const CompiledSurface& { return material(index); },
        [this](std::int32_t index, RayType ray) -> const OpacityProgram& {
            if (ray == RayType::Camera) return material(index).passing;
            const bool is_shadow = ray == RayType::Shadow || !hits;
            return is_shadow ? material(index).shadow : hits->surface(index, ray).passing;
        });
    asked.emitted = [this](std::int32_t index) { return emission->emitted(index); };
    if (volumes) volumes->tell(asked);
    // Once a material: instances may be many.
    std::vector<std::uint8_t> alone;
    for (std::size_t m = 0; m < scene.materials.size(); ++m)
        alone.push_back(scatters(static_cast<std::int32_t>(m)) ||
                        asks_itself(scene.materials[m].graph));
    const auto asks = [alone = std::move(alone)](std::int32_t index) {
        return index >= 0 && alone[static_cast<std::size_t>(index)] != 0;
    };
    if (any(asks)) asked.is_met_by_itself = asks;
    return asked;
}

}  // namespace granita
