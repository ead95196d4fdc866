// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shading_system.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/crash_report.h"
#include "base/stage_timer.h"
#include "shade/bounces/bounced_light.h"
#include "shade/bounces/hit_shader.h"
#include "shade/bounces/meets_light.h"
#include "shade/bounces/way_choice.h"
#include "shade/compiled_materials.h"
#include "shade/grid_channels.h"
#include "shade/interpolated_points.h"
#include "shade/lamp_shader.h"
#include "shade/left_to_samples.h"
#include "shade/lights/direct_light.h"
#include "shade/lights/light_sample_count.h"
#include "shade/material_displacement.h"
#include "shade/moving_eye.h"
#include "shade/nodes/material_emission.h"
#include "shade/nodes/node_compiler.h"
#include "shade/nodes/surface_run.h"
#include "shade/seen_points.h"
#include "shade/seen_triangles.h"
#include "shade/shading_input.h"
#include "shade/shading_points.h"
#include "shade/shadow_catchers.h"
#include "shade/shadow_transparency.h"
#include "shade/subsurface/shared_scattering.h"
#include "shade/subsurface/subsurface_light.h"
#include "shade/surface_pattern.h"
#include "shade/time_probes.h"
#include "shade/unsettled.h"
#include "shade/world_shader.h"

namespace granita {
namespace {

/// Metres: what scatters no farther is drawn as diffuse, as in Cycles.
constexpr float kLeastScattering = 1e-8f;

}  // namespace

struct ShadingSystem::Impl {
    const Scene& scene;
    Statistics& statistics;
    Report& report;
    const Progress& progress;
    TextureStore textures;
    ShadingCamera camera;
    MovingEye eye;
    ShutterWarp shutter;
    ChannelSet channels;
    std::vector<CompiledSurface> materials;  ///< [materials + 1]
    std::vector<std::vector<AttributeRequest>> requests;
    std::unique_ptr<MaterialEmission> emission;
    std::unique_ptr<MaterialDisplacement> displacement;  ///< nullptr: nothing is displaced
    WorldShader world;
    bool refines;
    bool moves;  ///< anything of the frame
    UnsettledThresholds thresholds;
    float footprint;  ///< of a sample, in steps of a grid
    std::shared_ptr<GeometryCache> geometries;
    std::shared_ptr<const ShadedGrids> shaded;  ///< of an earlier picture, or nullptr
    std::unique_ptr<Volumes> volumes;           ///< nullptr where nothing is filled
    std::unique_ptr<SeenVolumes> seen_volumes;  ///< likewise
    std::unique_ptr<DirectLight> light;         ///< nullptr where nothing that is seen reflects any
    std::unique_ptr<HitShader> hits;            ///< where light is followed or its rays told apart
    std::unique_ptr<BouncedLight> bounces;
    std::unique_ptr<SubsurfaceLight> below;    ///< where light is scattered below surfaces
    std::unique_ptr<ShadowCatchers> catchers;  ///< nullptr: there are none

    Impl(const Scene& s, Statistics& stats, Report& warnings, const Progress& p,
         bool refines_samples, const KeptShading& kept)
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
        displacement = std::make_unique<MaterialDisplacement>(
            scene, std::move(compiled.displacements), geometries, report, kept.offsets);
        if (!displacement->any()) displacement.reset();
        emission = std::make_unique<MaterialEmission>(scene, textures, materials);
        const bool any_reflects = std::ranges::any_of(scene.instances, [this](const Instance& i) {
            if (!i.visible_camera) return false;
            const auto shows = [this](int index) { return reflects(index); };
            return i.materials.empty() ? shows(-1) : std::ranges::any_of(i.materials, shows);
        });
        const bool nodes_ask_rays =
            std::ranges::any_of(scene.materials, asks_rays, &Material::graph);
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
        if (follows)
            bounces = std::make_unique<BouncedLight>(scene, *light, *hits, *emission, volumes.get(),
                                                     statistics, progress);
        if (volumes)
            seen_volumes = std::make_unique<SeenVolumes>(scene, *volumes, *light, bounces.get());
        if (!any([this](std::int32_t index) { return scatters(index); })) return;
        const auto bent = [this](std::int32_t index) {
            const SurfaceProgram& radiance = material(index).radiance;
            return radiance.bends_scattered() ? &material(index) : nullptr;
        };
        below = std::make_unique<SubsurfaceLight>(scene, *light, bounces.get(), bent, progress);
    }

    bool reflects(std::int32_t index) const { return material(index).radiance.sources.reflects(); }
    bool scatters(std::int32_t index) const { return material(index).radiance.scatters(); }
    const NodeGraph& graph_of(std::int32_t index) const {
        return scene.materials[static_cast<std::size_t>(index)].graph;
    }
    /// Whether it is so of any material of any instance.
    bool any(const std::function<bool(std::int32_t)>& is) const {
        return std::ranges::any_of(scene.instances, [&](const Instance& i) {
            return std::ranges::any_of(i.materials, is);
        });
    }

    void warn_of_broken(std::int32_t index, std::size_t count) const {
        if (count == 0) return;
        const std::string owner =
            index < 0 ? "no material"
                      : "material '" + scene.materials[static_cast<std::size_t>(index)].name + "'";
        report.warn(owner, "is not finite at some points, where it is left out", count);
    }

    RayMaterials ray_materials() const {
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

    const CompiledSurface& material(int index) const {
        return index < 0 ? materials.back() : materials[index];
    }

    template <class Points>
    ShadingInput input(const Grid& grid, const Points& points) const {
        return shading_input(grid, points, scene, light ? light->rays() : nullptr, progress);
    }

    /// Adds what surfaces send to each other: to points of a grid, whose `gathered` is filled, or
    /// to samples in it, whose diffuse lobes take it from there.  Returns what of it is noise at
    /// single points: what neighbours do not share.
    std::vector<Vec3f> add_bounces(const ShadingPoints& points, const SurfaceClosure& closure,
                                   LeavingRays& leaving, Grid& grid, ReflectionParts* parts,
                                   std::vector<float>* noise, std::vector<Vec3f>& radiance) const {
        const float due = points.share * static_cast<float>(scene.options.light_samples);
        if (!points.places.empty() && due < 1.0f) thin_out(leaving.rays, scene.options.seed);
        GatheredLight light = bounces->gather(leaving.rays, points.count);
        if (leaving.diffuse)
            share_gathered(points, closure, leaving.takes_world, parts != nullptr, light, grid);
        reflect_world(light, parts, noise, radiance);
        reflect_gathered(light, grid, closure, parts, radiance);
        return std::move(light.glossy);
    }

    /// Adds what is scattered below the surface, as add_bounces() of points or samples.
    void add_scattered(const ShadingPoints& points, const SurfaceClosure& closure,
                       const PointPaths& at, Grid& grid, ReflectionParts* parts,
                       std::vector<Vec3f>& radiance) const {
        if (grid.found.scattered.empty()) {
            ScatteredLight light = below->gather(points, closure, grid.key, at, parts);
            grid.found.scattered = std::move(light.direct);
            grid.found.scattered_bounced = std::move(light.bounced);
        }
        reflect_scattered(grid.found.scattered, grid.found.scattered_bounced, closure, parts,
                          radiance);
    }

    /// Fills radiance and channels of `grid`, whose points are `in.points`; `noise` as
    /// DirectLight::reflect(), `settled` [vertices] with the radiance but for what is noise at
    /// single points: empty where it is all.
    void shade(Grid& grid, const ShadingInput& in, const PointPaths& at,
               std::vector<float>* noise = nullptr, std::vector<Vec3f>* settled = nullptr) const {
        const CrashScope scope("shades", scene.instances[grid.instance].name);
        const SurfaceProgram& surface = material(grid.material).radiance;
        SurfaceRun ran(surface, in);
        const ShadingPoints& points = ran.points();
        SurfaceClosure closure = ran.take_closure();
        if (!closure.subsurface.empty()) {
            const bool has_body = below && light->rays()->has_body(grid.key);
            draw_as_diffuse(closure, has_body ? kLeastScattering : HUGE_VALF);
        }
        ReflectionParts parts, *asked = channels.empty() ? nullptr : &parts;
        std::vector<Vec3f> radiance(points.count, Vec3f(0.0f)), doubtful;
        LeavingRays leaving;
        leaving.diffuse = grid.found.gathered.empty();
        leaving.takes_world = bounces && scene.options.bounces.diffuse > 0 && surface.looks_ahead();
        if (light)
            radiance = light->reflect(points, closure, grid.key, asked, at, noise,
                                      bounces ? &leaving : nullptr);
        else if (asked)
            parts.resize(points.count);
        if (bounces && !closure.lobes.empty())
            doubtful = add_bounces(points, closure, leaving, grid, asked, noise, radiance);
        if (!closure.subsurface.empty()) add_scattered(points, closure, at, grid, asked, radiance);
        for (std::size_t i = 0; i < closure.emission.size(); ++i)
            radiance[i] += closure.emission[i];
        const std::size_t broken = ran.broken() + make_finite(radiance);
        grid.broken_radiance |= broken > 0;
        warn_of_broken(grid.material, broken);
        if (settled && !doubtful.empty()) {
            *settled = radiance;
            for (std::size_t i = 0; i < points.count; ++i) (*settled)[i] -= doubtful[i];
            make_finite(*settled);
            interpolate_points(grid, 1, *settled);
        }
        interpolate_points(grid, 1, radiance);
        grid.radiance = std::move(radiance);
        if (asked)
            fill_channels(grid, channels, scene, camera,
                          {points, closure, parts, ran.run(), surface.passes});
        statistics.add(Counter::PointsShaded, points.count);
    }

    /// Fills opacity of `grid`, whose points are `in.points`.
    void shade_opacity(Grid& grid, const ShadingInput& in) const {
        const CompiledSurface& surface = material(grid.material);
        Run run = surface.opacity_program.prepare(in, in.points->count);
        surface.opacity_program.execute(run);
        grid.opacity = values_of(run, surface.transparency);
        const std::size_t broken = make_finite(grid.opacity);
        grid.broken_opacity = broken > 0;
        warn_of_broken(grid.material, broken);
        for (Vec3f& opacity : grid.opacity)
            opacity = glm::clamp(Vec3f(1.0f) - opacity, Vec3f(0.0f), Vec3f(1.0f));
        interpolate_points(grid, 1, grid.opacity);
    }

    /// What interpolation misses is averaged by blur, as the noise of light samples is.
    float sharpness(const Grid& grid) const {
        return light_sample_step(light_sample_count(grid, scene, shutter));
    }
    float edge_share(const Grid& grid) const {
        return light_sample_step(edge_light_sample_count(grid, scene));
    }

    Grid refine(const Grid& grid, std::span<const RefinedPoint> wanted, float point_size) const {
        Grid out = refine_lit(grid, wanted, point_size);
        if (grid.found_alone) catchers->divide(out, grid, wanted, channels);
        return out;
    }

    Grid refine_lit(const Grid& from, std::span<const RefinedPoint> wanted,
                    float point_size) const {
        std::optional<SeenTriangles> seen;
        if (from.triangles) wanted = seen.emplace(from, wanted).points;
        const Grid& grid = seen ? seen->grid : from;
        RefinedPoints refined(grid, scene, camera, eye, wanted, moves, point_size);
        refined.points.round = kind_of(grid, scene) == GeometryKind::Curves;
        refined.points.narrow = refined.points.round && from.n_v == 1;
        // Small faces share what one bucket sees; ribbons' noise would fall by 3 %, bits differ.
        refined.points.alone = !grid.radiance.empty() || refined.points.round;
        if (light) light->lift(refined.points, grid.key);
        Grid out;
        out.key = grid.key;
        out.instance = grid.instance;
        out.material = grid.material;
        out.holdout = grid.holdout;
        out.n_u = static_cast<int>(wanted.size()) - 1;
        const Mat3f camera_from_world = glm::transpose(Mat3f(camera.world_from_camera));
        for (const Vec3f& p : refined.points.p) out.p.push_back(camera_from_world * p);
        out.found = refined.found;
        if (seen) out.opacity = std::move(seen->opacity);
        if (!grid.opacity.empty()) shade_opacity(out, input(grid, refined));
        shade(out, input(grid, refined), {});
        return out;
    }

    /// Whether samples of the grid can be shaded by themselves.  Strands and spheres are drawn as
    /// something flat, whose places say little of their shadows.
    bool can_refine(const Grid& grid) const {
        return refines && !grid.shades_faces() && kind_of(grid, scene) == GeometryKind::Mesh;
    }

    /// Whether each sample may say what light it sees of the grid.
    bool may_leave(const Grid& grid) const {
        return refines && reflects(grid.material) && !grid.holdout;
    }

    /// Whether some of the grid's micropolygons look otherwise at some time of the shutter than
    /// when it opens: all else being equal, light samples too.
    bool changes_in_time(Grid& grid) const {
        if (!moves || (!light && are_equal(grid.radiance))) return false;
        const TimeProbes probes(grid, scene.options.frame_time);
        const Grid found = refine(grid, probes.points, 1.0f);
        grid.broken_radiance |= found.broken_radiance || found.broken_opacity;
        return probes.any_changes(found.radiance, thresholds.difference, displayed_difference);
    }

    /// The same of its opacity: of what grazes the view, say.
    bool opacity_changes_in_time(Grid& grid) const {
        if (!moves) return false;
        const TimeProbes probes(grid, scene.options.frame_time);
        const RefinedPoints points(grid, scene, camera, eye, probes.points, moves, 1.0f);
        Grid out;
        out.material = grid.material;
        shade_opacity(out, input(grid, points));
        grid.broken_opacity |= out.broken_opacity;
        return probes.any_changes(out.opacity, thresholds.difference, opacity_difference);
    }

    /// Takes radiance from an equal grid of an earlier picture, shaded with as many light samples;
    /// false where there is none.
    bool take_shaded(Grid& grid, float share) const {
        const Grid* same = shaded ? shaded->find(grid) : nullptr;
        if (same == nullptr) return false;
        // What samples are shaded by themselves goes by the share itself.
        const bool is_enough = refines ? same->light_share == share
                                       : !light || light->sample_count(same->light_share) ==
                                                       light->sample_count(share);
        if (!is_enough) return false;
        take_shading(*same, grid);
        statistics.add(Counter::GridsShadedBefore);
        return true;
    }

    void shade_anew(Grid& grid, bool lit, float sharpness) const {
        ShadingPoints points = shading_points(grid, camera);
        const bool wants_refining = can_refine(grid);
        const float narrow = edge_share(grid), fewer = sharpness * narrow;
        points.share *= fewer;
        points.round = kind_of(grid, scene) == GeometryKind::Curves;
        if (light && lit) light->lift(points, grid.key);
        const PointPaths at =
            light && light->varies() ? PointPaths(grid, scene, points) : PointPaths();
        if (bounces && lit)
            look_at(points, at, grid.key, *light->rays(), scene, eye, moves ? &shutter : nullptr,
                    std::min(1.0f, edge_light_share(scene.options.samples) / narrow));
        if (wants_refining && may_leave(grid) && !grid.opacity_varies && !scatters(grid.material) &&
            pays_by_samples(grid, points, scene, *light))
            return leave_to_samples(grid, channels.vertex_width());
        std::vector<float> noise(wants_refining ? points.count : 0, 0.0f);
        std::vector<Vec3f> settled;
        const bool catches = catchers && scene.catches_shadows(grid.instance, grid.material);
        shade(grid, input(grid, points), at, wants_refining ? &noise : nullptr,
              wants_refining && !catches ? &settled : nullptr);
        statistics.add(Counter::GridsShaded);
        if (catches) catchers->divide(grid, channels, noise);
        if (!wants_refining) return;
        if (grid.holdout && !catches) {
            grid.unsettled = grid.unsettled_opacity;
            return;
        }
        if (material(grid.material).has_lines() || changes_in_time(grid))
            grid.unsettled = all_micropolygons(grid);
        else
            find_unsettled(grid, settled, noise, thresholds.difference / (sharpness * sharpness),
                           thresholds.noise / (fewer * fewer));
    }
};

ShadingSystem::ShadingSystem(const Scene& scene, Statistics& statistics, Report& report,
                             const Progress& progress, bool refines, const KeptShading& kept)
    : m_impl(std::make_unique<Impl>(scene, statistics, report, progress, refines, kept)) {}

ShadingSystem::~ShadingSystem() = default;

const std::vector<std::vector<AttributeRequest>>& ShadingSystem::requests() const {
    return m_impl->requests;
}

float ShadingSystem::threshold() const {
    return m_impl->thresholds.difference;
}

const MaterialDisplacement* ShadingSystem::displacement() const {
    return m_impl->displacement.get();
}

bool ShadingSystem::has_light() const {
    return m_impl->light != nullptr;
}

std::shared_ptr<GeometryCache> ShadingSystem::geometries() const {
    return m_impl->geometries;
}

bool ShadingSystem::opacity_varies(int material) const {
    return !m_impl->material(material).transparency.is(Vec3f(0.0f));
}

bool ShadingSystem::opacity_asks_rays(int material) const {
    return material >= 0 && opacity_varies(material) && asks_rays(m_impl->graph_of(material));
}

bool ShadingSystem::reaches_others(int material) const {
    return !m_impl->material(material).shadow.transparency.is(Vec3f(0.0f)) ||
           m_impl->emission->any(material) ||
           m_impl->material(material).radiance.bends_scattered() ||
           (m_impl->volumes && m_impl->volumes->fills(material));
}

void ShadingSystem::shade_opacity(Grid& grid) const {
    if (!opacity_varies(grid.material)) return;
    const ShadingPoints points = shading_points(grid, m_impl->camera);
    m_impl->shade_opacity(grid, m_impl->input(grid, points));
    const CompiledSurface& surface = m_impl->material(grid.material);
    const bool refines = m_impl->can_refine(grid), has_lines = refines && surface.has_lines();
    const auto is_open = [](const Vec3f& opacity) { return opacity != Vec3f(1.0f); };
    grid.opacity_varies = has_lines || std::ranges::any_of(grid.opacity, is_open);
    grid.additive = surface.radiance.sources.additive;
    if (grid.opacity_varies && refines) {
        const float sharpness = m_impl->sharpness(grid);
        const float threshold = m_impl->thresholds.difference / (sharpness * sharpness);
        grid.unsettled_opacity = has_lines || m_impl->opacity_changes_in_time(grid)
                                     ? all_micropolygons(grid)
                                     : unsettled_opacity(grid, threshold);
    }
    m_impl->statistics.add(Counter::GridsOpacityShaded);
}

bool ShadingSystem::leaves_to_samples(const Grid& grid) const {
    // Small faces that are not solid stay with their corners.
    return grid.triangles && !(grid.disjoint && grid.opacity_varies) && m_impl->may_leave(grid);
}

void ShadingSystem::shade_radiance(Grid& grid) const {
    if (leaves_to_samples(grid)) return leave_to_samples(grid, m_impl->channels.vertex_width());
    const bool lit = m_impl->reflects(grid.material);
    const float sharpness = lit || m_impl->can_refine(grid) ? m_impl->sharpness(grid) : 1.0f;
    const float share = grid.point_share * sharpness * m_impl->edge_share(grid);
    if (m_impl->take_shaded(grid, share)) return;
    m_impl->shade_anew(grid, lit, sharpness);
    grid.light_share = share;
}

Grid ShadingSystem::refine(const Grid& grid, std::span<const RefinedPoint> wanted) const {
    m_impl->statistics.add(Counter::PointsRefined, wanted.size());
    return m_impl->refine(grid, wanted, m_impl->footprint);
}

void ShadingSystem::background(const BackgroundRays& rays, std::vector<Vec3f>& out) const {
    m_impl->world.background(rays, out);
}

TextureStore& ShadingSystem::textures() const {
    return m_impl->textures;
}

const SeenVolumes* ShadingSystem::volumes() const {
    return m_impl->seen_volumes.get();
}

bool ShadingSystem::background_is_constant() const {
    return m_impl->world.is_constant(RayType::Camera);
}

}  // namespace granita
