// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shading_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/crash_report.h"
#include "base/stage_timer.h"
#include "shade/grid_channels.h"
#include "shade/interpolated_points.h"
#include "shade/lights/direct_light.h"
#include "shade/lights/light_sample_count.h"
#include "shade/material_displacement.h"
#include "shade/nodes/node_compiler.h"
#include "shade/shading_points.h"
#include "shade/shadow_transparency.h"
#include "shade/time_probes.h"
#include "shade/unsettled.h"
#include "shade/world_shader.h"

namespace granita {

namespace {

/// Blender's look for a slot without a material.
NodeGraph default_material() {
    NodeGraph graph;
    Node diffuse{"ShaderNodeBsdfDiffuse", "Default", {}, {}};
    diffuse.inputs["Color"] = Vec4f(0.8f, 0.8f, 0.8f, 1.0f);
    graph.nodes.push_back(std::move(diffuse));
    graph.surface = {0, "BSDF"};
    return graph;
}

/// Radiance of a surface that nobody misses as a light: an 8-bit step of white.
constexpr float kDimmestEmission = 0.004f;

template <class T>
std::vector<T> values_of(const Run& run, const Source<T>& source) {
    const Column<T> column = run.read(source);
    std::vector<T> values(run.count());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = column[i];
    return values;
}

/// Values that are no numbers become 0; returns how many did.
std::size_t make_finite(std::vector<Vec3f>& values) {
    std::size_t broken = 0;
    for (Vec3f& value : values)
        if (!is_finite(value)) {
            value = Vec3f(0.0f);
            ++broken;
        }
    return broken;
}

/// `broken` counts weights of lobes that are no numbers: as in Cycles such a lobe is not there.
SurfaceClosure closure_of(const Run& run, const SurfaceSources& sources, std::size_t& broken) {
    SurfaceClosure closure;
    for (const LobeSource& from : sources.lobes) {
        Lobe lobe;
        lobe.kind = from.kind;
        lobe.distribution = from.distribution;
        lobe.fresnel = from.fresnel;
        lobe.multiscatter = from.multiscatter;
        lobe.separable_masking = from.separable_masking;
        lobe.burley = from.burley;
        lobe.cosine_bumps = from.cosine_bumps;
        lobe.weight = values_of(run, from.weight);
        broken += make_finite(lobe.weight);
        lobe.normal = values_of(run, from.normal);
        lobe.roughness = values_of(run, from.roughness);
        if (from.fresnel != FresnelKind::None || from.has_color) lobe.f0 = values_of(run, from.f0);
        if (from.fresnel != FresnelKind::None) lobe.f90 = values_of(run, from.f90);
        if (from.fresnel == FresnelKind::Dielectric) lobe.ior = values_of(run, from.ior);
        closure.lobes.push_back(std::move(lobe));
    }
    if (!sources.emission.is(Vec3f(0.0f))) closure.emission = values_of(run, sources.emission);
    if (!sources.transparency.is(Vec3f(0.0f)))
        closure.transparency = values_of(run, sources.transparency);
    return closure;
}

constexpr float kNoThreshold = std::numeric_limits<float>::infinity();

/// Refined samples have one light sample each, or a few; corners have Options::light_samples, and
/// those of their neighbours.  What moves is in doubt about its time, which only samples know.
bool refining_spares_noise(const Options& options, bool moves) {
    return moves || options.samples >= 3 * options.light_samples;
}

}  // namespace

struct ShadingSystem::Impl {
    const Scene& scene;
    Statistics& statistics;
    Report& report;
    TextureStore textures;
    ShadingCamera camera;
    ShutterWarp shutter;
    ChannelSet channels;
    std::vector<CompiledSurface> materials;  ///< [materials + 1]
    std::vector<std::vector<AttributeRequest>> requests;
    std::unique_ptr<MaterialDisplacement> displacement;  ///< nullptr: nothing is displaced
    WorldShader world;
    bool refines;
    bool moves;                        ///< anything of the frame
    float threshold, noise_threshold;  ///< of unsettled_micropolygons()
    float footprint;                   ///< of a sample, in steps of a grid
    std::shared_ptr<GeometryCache> geometries;
    std::unique_ptr<DirectLight> light;  ///< nullptr where nothing that is seen reflects any

    Impl(const Scene& s, Statistics& stats, Report& warnings, const Progress& progress,
         bool refines_samples, const KeptShading& kept)
        : scene(s),
          statistics(stats),
          report(warnings),
          textures(s, stats, report),
          camera(s),
          shutter(s.options.shutter_curve),
          channels(s.options),
          world(s, textures, report),
          refines(refines_samples),
          moves(s.moves()),
          threshold(s.options.shading_threshold * 8.0f /
                    std::sqrt(static_cast<float>(s.options.samples))),
          noise_threshold(refining_spares_noise(s.options, s.moves()) ? threshold : kNoThreshold),
          footprint(1.0f / std::sqrt(static_cast<float>(s.options.samples))),
          geometries(std::make_shared<GeometryCache>(kept.geometry)) {
        const StageTimer timer(stats, Stage::Shade);
        const ChannelSet* passes = channels.empty() ? nullptr : &channels;
        std::vector<std::optional<DisplacementProgram>> displacements;
        for (const Material& material : scene.materials) {
            progress.check();
            const std::string owner = "material '" + material.name + "'";
            materials.push_back(compile_surface(material.graph, scene, textures, report,
                                                {owner, false, material.index}, passes));
            std::optional<DisplacementProgram>& moved = displacements.emplace_back();
            if (material.graph.moves_surface())
                moved = compile_displacement(material.graph, scene, textures, report,
                                             {owner, false, material.index});
        }
        materials.push_back(
            compile_surface(default_material(), scene, textures, report, {"no material"}, passes));
        for (const CompiledSurface& material : materials) requests.push_back(material.requests);
        displacement = std::make_unique<MaterialDisplacement>(scene, std::move(displacements),
                                                              geometries, report);
        if (!displacement->any()) displacement.reset();
        warn_of_emission();
        const bool any_reflects = std::ranges::any_of(scene.instances, [this](const Instance& i) {
            if (!i.visible_camera) return false;
            const auto shows = [this](int index) { return reflects(index); };
            return i.materials.empty() ? shows(-1) : std::ranges::any_of(i.materials, shows);
        });
        if (!any_reflects) return;
        light = std::make_unique<DirectLight>(scene, world.evaluator(), statistics, report,
                                              progress, shadow_opacity(), geometries, kept.rays,
                                              displacement.get());
    }

    bool reflects(std::int32_t index) const {
        return !material(index).radiance.sources.lobes.empty();
    }

    /// Only lamps and the world are sampled: a surface that shines is seen, but sheds no light.
    void warn_of_emission() const {
        const auto count = static_cast<std::int32_t>(scene.materials.size());
        bool any = false;
        for (std::int32_t i = 0; i < count && !any; ++i) any = reflects(i);
        if (!any) return;
        for (std::size_t i = 0; i < scene.materials.size(); ++i) {
            const auto& emission = materials[i].radiance.sources.emission;
            if (emission.is_constant() && luminance(emission.constant) < kDimmestEmission) continue;
            report.warn("material '" + scene.materials[i].name + "'",
                        "its emission is seen but lights nothing: add a lamp where it should");
        }
    }

    void warn_of_broken(std::int32_t index, std::size_t count) const {
        if (count == 0) return;
        const std::string owner =
            index < 0 ? "no material"
                      : "material '" + scene.materials[static_cast<std::size_t>(index)].name + "'";
        report.warn(owner, "is not finite at some points, where it is left out", count);
    }

    ShadowOpacity shadow_opacity() const {
        return {
            [this](std::int32_t index) {
                return !material(index).shadow.transparency.is(Vec3f(0.0f));
            },
            [this](const ShadowHit& hit) {
                return shadow_transparency(material(hit.material).shadow, scene, hit);
            },
            [this](std::int32_t index) { return constant_transparency(material(index).shadow); }};
    }

    const CompiledSurface& material(int index) const {
        return index < 0 ? materials.back() : materials[index];
    }

    ShadingInput input(const Grid& grid, const ShadingPoints& points) const {
        ShadingInput in;
        in.points = &points;
        in.attributes = &grid.attributes;
        in.instance = &scene.instances[grid.instance];
        in.axes = ObjectAxes(matrix_at(in.instance->world_from_object, scene.options.frame_time));
        return in;
    }

    ShadingInput input(const Grid& grid, const RefinedPoints& refined) const {
        ShadingInput in = input(grid, refined.points);
        in.attributes = &refined.attributes;
        in.axes_at_times = refined.axes_at_times;
        return in;
    }

    /// Fills radiance and channels of `grid`, whose points are `in.points`; `noise` as
    /// DirectLight::reflect().
    void shade(Grid& grid, const ShadingInput& in, const PointPaths& at,
               std::vector<float>* noise = nullptr) const {
        const CrashScope scope("shades", scene.instances[grid.instance].name);
        const SurfaceProgram& surface = material(grid.material).radiance;
        Run run = surface.program.prepare(in, in.points->count);
        surface.program.execute(run);
        // Light then knows no other normal, and does not fade as where a node bends one.
        std::optional<ShadingPoints> bent;
        if (surface.is_bumped) {
            bent = *in.points;
            bent->normal = values_of(run, surface.bumped);
        }
        const ShadingPoints& points = bent ? *bent : *in.points;
        std::size_t broken = 0;
        const SurfaceClosure closure = closure_of(run, surface.sources, broken);
        const bool has_passes = !channels.empty();
        ReflectionParts parts;
        std::vector<Vec3f> radiance(points.count, Vec3f(0.0f));
        if (light)
            radiance =
                light->reflect(points, closure, grid.key, has_passes ? &parts : nullptr, at, noise);
        else
            parts.resize(has_passes ? points.count : 0);
        for (std::size_t i = 0; i < closure.emission.size(); ++i)
            radiance[i] += closure.emission[i];
        warn_of_broken(grid.material, broken + make_finite(radiance));
        interpolate_points(grid, 1, radiance);
        grid.radiance = std::move(radiance);
        if (has_passes)
            fill_channels(grid, channels, scene, camera,
                          {points, closure, parts, run, surface.passes});
        statistics.add(Counter::PointsShaded, points.count);
    }

    /// Fills opacity of `grid`, whose points are `in.points`.
    void shade_opacity(Grid& grid, const ShadingInput& in) const {
        const CompiledSurface& surface = material(grid.material);
        Run run = surface.opacity_program.prepare(in, in.points->count);
        surface.opacity_program.execute(run);
        grid.opacity = values_of(run, surface.transparency);
        warn_of_broken(grid.material, make_finite(grid.opacity));
        for (Vec3f& opacity : grid.opacity)
            opacity = glm::clamp(Vec3f(1.0f) - opacity, Vec3f(0.0f), Vec3f(1.0f));
        interpolate_points(grid, 1, grid.opacity);
    }

    /// What interpolation misses is averaged by blur, as the noise of light samples is.
    float sharpness(const Grid& grid) const { return light_sample_count(grid, scene, shutter); }

    Grid refine(const Grid& grid, std::span<const RefinedPoint> wanted, float point_size) const {
        RefinedPoints refined(grid, scene, camera, wanted, moves, point_size);
        if (light) light->lift(refined.points, grid.key);
        Grid out;
        out.key = grid.key;
        out.instance = grid.instance;
        out.material = grid.material;
        out.n_u = static_cast<int>(wanted.size()) - 1;
        const Mat3f camera_from_world = glm::transpose(Mat3f(camera.world_from_camera));
        for (const Vec3f& p : refined.points.p) out.p.push_back(camera_from_world * p);
        if (!grid.opacity.empty()) shade_opacity(out, input(grid, refined));
        shade(out, input(grid, refined), {});
        return out;
    }

    /// Whether samples of the grid can be shaded by themselves.  Strands and spheres are drawn as
    /// something flat, whose places say little of their shadows.
    bool can_refine(const Grid& grid) const {
        if (!refines || grid.shades_faces()) return false;
        const std::int32_t index = scene.instances[grid.instance].geometry;
        return scene.geometries[static_cast<std::size_t>(index)].kind == GeometryKind::Mesh;
    }

    /// Whether some of the grid's micropolygons look otherwise at some time of the shutter than
    /// when it opens: all else being equal, light samples too.
    bool changes_in_time(const Grid& grid) const {
        if (!moves || (!light && are_equal(grid.radiance))) return false;
        return any_changes(refine(grid, time_probes(grid), 1.0f).radiance, threshold,
                           displayed_difference);
    }

    /// The same of its opacity: of what grazes the view, say.
    bool opacity_changes_in_time(const Grid& grid) const {
        if (!moves) return false;
        const RefinedPoints points(grid, scene, camera, time_probes(grid), moves, 1.0f);
        Grid out;
        out.material = grid.material;
        shade_opacity(out, input(grid, points));
        return any_changes(out.opacity, threshold, opacity_difference);
    }

    std::vector<std::uint8_t> all_marked(const Grid& grid) const {
        return std::vector<std::uint8_t>(static_cast<std::size_t>(grid.micropolygon_count()), 1);
    }

    PointPaths paths(const Grid& grid, const ShadingPoints& points) const {
        return light && light->varies() ? PointPaths(grid, scene, points) : PointPaths();
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
    return m_impl->threshold;
}

const Displacement* ShadingSystem::displacement() const {
    return m_impl->displacement.get();
}

std::shared_ptr<GeometryCache> ShadingSystem::geometries() const {
    return m_impl->geometries;
}

bool ShadingSystem::opacity_varies(int material) const {
    return !m_impl->material(material).transparency.is(Vec3f(0.0f));
}

void ShadingSystem::shade_opacity(Grid& grid) const {
    if (!opacity_varies(grid.material)) return;
    const ShadingPoints points = shading_points(grid, m_impl->camera);
    m_impl->shade_opacity(grid, m_impl->input(grid, points));
    grid.opacity_varies = std::any_of(grid.opacity.begin(), grid.opacity.end(),
                                      [](const Vec3f& opacity) { return opacity != Vec3f(1.0f); });
    grid.additive = m_impl->material(grid.material).radiance.sources.additive;
    if (grid.opacity_varies && m_impl->can_refine(grid)) {
        const float sharpness = m_impl->sharpness(grid);
        grid.unsettled_opacity =
            m_impl->opacity_changes_in_time(grid)
                ? m_impl->all_marked(grid)
                : unsettled_opacity(grid, m_impl->threshold / (sharpness * sharpness));
    }
    m_impl->statistics.add(Counter::GridsOpacityShaded);
}

void ShadingSystem::shade_radiance(Grid& grid) const {
    const CompiledSurface& material = m_impl->material(grid.material);
    ShadingPoints points = shading_points(grid, m_impl->camera);
    const bool refines = m_impl->can_refine(grid);
    const bool lit = !material.radiance.sources.lobes.empty();
    const float sharpness = lit || refines ? m_impl->sharpness(grid) : 1.0f;
    points.share *= sharpness;
    if (m_impl->light && lit) m_impl->light->lift(points, grid.key);
    std::vector<float> noise(refines ? points.count : 0, 0.0f);
    m_impl->shade(grid, m_impl->input(grid, points), m_impl->paths(grid, points),
                  refines ? &noise : nullptr);
    m_impl->statistics.add(Counter::GridsShaded);
    if (!refines) return;
    if (grid.holdout) {
        grid.unsettled = grid.unsettled_opacity;
        return;
    }
    grid.unsettled =
        m_impl->changes_in_time(grid)
            ? m_impl->all_marked(grid)
            : unsettled_micropolygons(grid, noise, m_impl->threshold / (sharpness * sharpness),
                                      m_impl->noise_threshold / (sharpness * sharpness));
    if (grid.unsettled.empty()) grid.unsettled = grid.unsettled_opacity;
    for (std::size_t m = 0; m < grid.unsettled_opacity.size(); ++m)
        grid.unsettled[m] |= grid.unsettled_opacity[m];
}

Grid ShadingSystem::refine(const Grid& grid, std::span<const RefinedPoint> wanted) const {
    m_impl->statistics.add(Counter::PointsRefined, wanted.size());
    return m_impl->refine(grid, wanted, m_impl->footprint);
}

void ShadingSystem::background(const std::vector<Vec3f>& directions, float spread,
                               std::vector<Vec3f>& out) const {
    m_impl->world.radiance(directions, spread, RayType::Camera, out);
}

bool ShadingSystem::background_is_constant() const {
    return m_impl->world.is_constant(RayType::Camera);
}

}  // namespace granita
