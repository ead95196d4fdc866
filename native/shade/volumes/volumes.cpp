// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/volumes/volumes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/sampling.h"
#include "scene/knot_time.h"
#include "shade/programs/shading_camera.h"

namespace granita {
namespace {

constexpr std::array kRays{RayType::Camera, RayType::Shadow,      RayType::Diffuse,
                           RayType::Glossy, RayType::Singular,    RayType::Transmission,
                           RayType::Clear,  RayType::Translucent, RayType::Scattered};
static_assert(kRays.size() == kRayTypes);

/// In [0, 1), of where a ray goes.
float shift_of(const Ray& ray) {
    std::uint64_t bits = 0;
    for (int axis = 0; axis < 3; ++axis)
        bits = mix_bits(bits ^ std::bit_cast<std::uint32_t>(ray.start[axis]) ^
                        std::uint64_t{std::bit_cast<std::uint32_t>(ray.direction[axis])} << 32);
    return unit_float(bits);
}

/// Of a thing's mean extent.
constexpr float kStep = 0.1f;
/// Metres: Cycles' default.
constexpr float kWorldStep = 1.0f;

}  // namespace

bool Volumes::any(const Scene& scene) {
    if (scene.world.is_filled()) return true;
    return std::ranges::any_of(scene.instances, [&](const Instance& instance) {
        return std::ranges::any_of(instance.materials, [&](std::int32_t index) {
            return index >= 0 &&
                   scene.materials[static_cast<std::size_t>(index)].graph.has_volume();
        });
    });
}

Volumes::Volumes(const Scene& scene, TextureStore& textures, Report& report) : m_scene(scene) {
    for (const Material& material : scene.materials)
        m_materials.push_back(compile(material.graph, textures, report,
                                      {"material '" + material.name + "'", false, material.index}));
    if (scene.world.is_filled())
        m_world = compile(scene.world.graph, textures, report,
                          {"world '" + scene.world.name + "'", true});
    measure();
}

/// Steps are a tenth of a thing's mean extent, as Cycles has them where there are no voxels.
void Volumes::measure() {
    const float frame = m_scene.options.frame_time;
    m_things.origin = Vec3d(ShadingCamera(m_scene).world_from_camera[3]);
    m_things.steps[FilledThings::kWorld] = kWorldStep;
    for (std::uint32_t i = 0; i < m_scene.instances.size(); ++i) {
        const Instance& instance = m_scene.instances[i];
        const auto is_filled = [this](std::int32_t material) { return fills(material); };
        if (std::ranges::none_of(instance.materials, is_filled)) continue;
        const GeometryData& data = m_scene.geometry_of(instance);
        const int knot = static_cast<int>(std::lround(frame * static_cast<float>(data.knots - 1)));
        const VolumeSpace& space =
            m_things.spaces.emplace(i, VolumeSpace(data, knot)).first->second;
        const Mat3d axes(matrix_at(instance.world_from_object, frame));
        double extent = 0.0;  // of the box around the box
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                extent += std::abs(axes[column][row]) * space.size[column];
        m_things.steps[i] = std::max(static_cast<float>(extent) * (kStep / 3.0f), 1e-6f);
    }
}

Volumes::Programs Volumes::compile(const NodeGraph& graph, TextureStore& textures, Report& report,
                                   const GraphOwner& owner) {
    Programs programs;
    if (!graph.has_volume()) return programs;
    for (const RayType ray : kRays) {
        auto& program = programs.of_ray[static_cast<std::size_t>(ray)];
        const RayType alike = first_alike(graph, graph.volume, ray, kRays);
        if (alike != ray) {
            program = programs.of_ray[static_cast<std::size_t>(alike)];
            continue;
        }
        Report warnings;
        program = std::make_shared<const VolumeProgram>(
            compile_volume(graph, m_scene, textures, warnings, owner, ray));
        report.add_new(warnings);
        m_shines |= !program->emission.is(Vec3f(0.0f));
        for (const PhaseSource& phase : program->sources.phases) {
            m_scatters = true;
            m_phase_kinds.insert(phase.kind);
        }
    }
    return programs;
}

RayMaterials::Inside Volumes::inside(std::int32_t material) const {
    if (material < 0) return RayMaterials::Inside::Nothing;
    const NodeGraph& graph = m_scene.materials[static_cast<std::size_t>(material)].graph;
    if (!graph.has_volume()) return RayMaterials::Inside::Nothing;
    return graph.has_only_volume() ? RayMaterials::Inside::VolumeAlone
                                   : RayMaterials::Inside::Volume;
}

void Volumes::tell(RayMaterials& materials) const {
    materials.inside = [this](std::int32_t material) { return inside(material); };
    materials.dim = [this](std::span<const Ray> rays, std::span<Vec3f> left) { dim(rays, left); };
}

void Volumes::find(std::span<const Ray> rays, RayMedia& media) const {
    MediaFiller filler(m_scene, m_things, media);
    std::vector<VolumeSpan> spans;
    std::vector<FilledSpan> filled;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto type = static_cast<std::size_t>(rays[i].type);
        filled.clear();
        if (const auto& world = m_world.of_ray[type])
            filled.push_back({world.get(), FilledThings::kWorld, -1, 0.0f, rays[i].distance});
        m_rays->volumes(rays[i], spans);
        for (const VolumeSpan& span : spans)
            filled.push_back(
                {m_materials[static_cast<std::size_t>(span.material)].of_ray[type].get(),
                 span.instance, span.material, span.begin, span.end});
        filler.add_ray(rays[i], shift_of(rays[i]), filled);
    }
    filler.fill();
}

void Volumes::dim(std::span<const Ray> rays, std::span<Vec3f> left) const {
    std::vector<Ray> asked;
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (left[i] == Vec3f(0.0f) || rays[i].type == RayType::Camera) continue;
        asked.push_back(rays[i]);
        asked.back().type = RayType::Shadow;
        numbers.push_back(static_cast<std::uint32_t>(i));
    }
    if (asked.empty()) return;
    RayMedia media;
    find(asked, media);
    for (std::size_t k = 0; k < asked.size(); ++k) {
        MediumWalk walk(media.of(k));
        walk.advance(asked[k].distance);
        left[numbers[k]] *= walk.transmittance();
    }
}

}  // namespace granita
