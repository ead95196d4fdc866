// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/direct_light.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "base/stage_timer.h"
#include "scene/camera_path.h"
#include "scene/knot_time.h"
#include "shade/bsdf/bsdf.h"
#include "shade/lights/grid_samples.h"
#include "shade/lights/lamp_choices.h"
#include "shade/lights/lamp_samples.h"
#include "shade/lights/lamp_set.h"
#include "shade/lights/leaving_rays.h"
#include "shade/lights/lit_grid.h"
#include "shade/lights/lit_points.h"
#include "shade/lights/lobe_runs.h"
#include "shade/lights/met_lamps.h"
#include "shade/lights/mirrored_lamps.h"
#include "shade/lights/part_rays.h"
#include "shade/lights/power_heuristic.h"
#include "shade/lights/world_light.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Points of an aligned square of the grid, which share a choice of lamps.
constexpr std::uint32_t kSharing = 16;
/// Points that many samples of the picture see ask as many times more lamps as noise would allow if
/// a pixel had so many.
constexpr int kSamplesOfAsked = 16;

/// Of shading space.
Vec3d camera_origin(const Scene& scene) {
    return Vec3d(CameraPath(scene.camera).world_from_camera(scene.options.frame_time)[3]);
}

}  // namespace

struct DirectLight::Impl {
    Impl(const Scene& scene, WorldEvaluator world_evaluator, Statistics& frame_statistics,
         Report& report, const Progress& progress, RayMaterials materials,
         std::shared_ptr<GeometryCache> cache, std::shared_ptr<PersistentRays> persistent_rays,
         const Displacement* displacement, const LightPatterns& patterns, bool nodes_ask_rays);

    LitGrid lit_grid(const ShadingPoints& points, const SurfaceClosure& closure, const GridKey& key,
                     std::vector<Vec3f>& radiance) const;
    void light_points(LitGrid& grid, const std::vector<LitPoint>& points, std::size_t lobe_count,
                      std::vector<LampSight>* sights) const;
    void count(const LitGrid& grid) const;
    void sample_lobe(LitGrid& grid, const LitPoint& point, std::size_t lobe,
                     const LampChoices& choices) const;
    void sample_rest(LitGrid& grid, const LitPoint& point, const LampChoices& choices) const;
    void mirror(LitGrid& grid, const LitPoint& point, std::size_t lobe) const;
    std::uint64_t receives(const GridKey& key) const;

    const Scene& scene;
    Statistics& statistics;
    const Progress& progress;
    std::shared_ptr<GeometryCache> geometries;
    LampSet set;
    float finer_by_corner;  ///< how many times more lamps these ask
    WorldLight world;
    std::unordered_map<std::uint32_t, std::uint64_t> linked;  ///< Instance::receives by key
    std::vector<LightAnchor> anchors;
    LampFaces shining;
};

DirectLight::Impl::Impl(const Scene& frame_scene, WorldEvaluator world_evaluator,
                        Statistics& frame_statistics, Report& report,
                        const Progress& frame_progress, RayMaterials materials,
                        std::shared_ptr<GeometryCache> cache,
                        std::shared_ptr<PersistentRays> persistent_rays,
                        const Displacement* displacement, const LightPatterns& patterns,
                        bool nodes_ask_rays)
    : scene(frame_scene),
      statistics(frame_statistics),
      progress(frame_progress),
      geometries(cache ? std::move(cache) : std::make_shared<GeometryCache>()),
      set(frame_scene.options),
      finer_by_corner(std::sqrt(static_cast<float>(scene.options.samples) / kSamplesOfAsked)),
      world(scene.world, std::move(world_evaluator), report, progress) {
    for (const Instance& instance : scene.instances)
        if (instance.receives != ~0ULL) linked[instance.key] = instance.receives;
    set.parallel_view = !scene.camera.projection.perspective;
    const Vec3d origin = camera_origin(scene);
    std::vector<Lamp> lamps = lamps_of(scene, origin, patterns);
    const bool asks_rays =
        nodes_ask_rays || world.shines() || scene.options.bounces.most > 0 ||
        std::ranges::any_of(lamps, [](const Lamp& lamp) { return lamp.casts_shadow(); }) ||
        std::ranges::any_of(scene.instances,
                            [&](const Instance& instance) {
                                return materials.shines(instance) ||
                                       materials.meets_itself(instance);
                            }) ||
        materials.dim;
    if (asks_rays) {
        StageTimer timer(statistics, Stage::RayBuild);
        auto rays = std::make_unique<RayScene>(scene, origin, materials, progress, geometries,
                                               &report, std::move(persistent_rays), displacement);
        statistics.peak_ray_bytes(rays->bytes());
        shining = LampFaces(scene, *rays, materials, patterns, report, progress);
        std::ranges::move(shining.take_lamps(), std::back_inserter(lamps));
        if (!rays->empty()) set.set_casters(std::move(rays));
    }
    // What moves past lamps and shadows that stand still is lit by its way, be it no caster itself.
    set.varies =
        set.varies || std::ranges::any_of(scene.instances, [&](const Instance& instance) {
            return !is_static(instance.world_from_object) || scene.geometry_of(instance).knots > 1;
        });
    anchors = anchors_of(lamps);
    set.set_lamps(std::move(lamps), progress);
}

std::uint64_t DirectLight::Impl::receives(const GridKey& key) const {
    const auto found = linked.find(key.instance);
    return found == linked.end() ? ~0ULL : found->second;
}

void DirectLight::Impl::sample_lobe(LitGrid& grid, const LitPoint& point, std::size_t lobe,
                                    const LampChoices& choices) const {
    const bool meets_lamps = point.meets_lamps(lobe);
    const bool any_unasked = grid.depth > set.asked_by_all;
    if (!world.shines() && !meets_lamps && !any_unasked && !grid.leaving) return;
    if (!meets_lamps && !grid.samples_diffuse()) return;
    const LitPoint::LobeSamples& samples = point.samples[lobe];
    const SobolPoints sequence = grid.sequence(1 + point.bsdf.index(lobe), samples.first);
    for (int s = 0; s < samples.count; ++s) {
        const auto index = static_cast<std::uint32_t>(s);
        Vec3f wo;
        if (!point.bsdf.sample(lobe, sequence(index), wo)) continue;
        const BsdfValue value = point.bsdf.evaluate(wo, true);
        if (total(value) == Vec3f(0.0f)) continue;
        const RayType type = grid.blurred_rays(point.is_through(wo)).of(point.bsdf.part(lobe));
        const LitPlace place = set.place_at(point, sequence.third(index));
        const float sign = LitGrid::sign(s, samples.count);
        const float likely = grid.leaving ? point.chance_density(wo) : 0.0f;
        if (grid.leaving && (grid.leaving->diffuse || meets_lamps)) {
            Ray ray = set.ray(point, place, wo, kInfinity, type);
            if (grid.leaving->diffuse) {
                const float chance = grid.chance(samples.first + index, point.bsdf.index(lobe));
                const LightPart part = point.counted_as(lobe, wo, chance);
                ray.type = grid.blurred_rays(point.is_through(wo)).of(part);
            }
            BsdfValue sent = value;
            if (!grid.leaving->diffuse) sent.diffuse = Vec3f(0.0f);
            const float density =
                grid.leaving->diffuse ? point.all_density(wo) : point.meeting_density(wo);
            const WorldAhead ahead =
                grid.carries_world()
                    ? world.ahead(set, grid, point, {wo, sent, sign, type, meets_lamps})
                    : WorldAhead();
            const float chosen =
                grid.leaving->diffuse
                    ? likely
                    : point.chance_density(wo, [&](std::size_t k) { return point.meets_lamps(k); });
            leave(set, grid, point, ray, sent * Vec3f(1.0f / density), {chosen / density, likely},
                  samples.first + index, ahead);
        }
        if (grid.wants_ways_alone()) continue;
        if (world.shines() && !grid.carries_world())
            world.meet(set, grid, point, place, {wo, value, sign, type, meets_lamps});
        if (!meets_lamps && !any_unasked) continue;
        const auto meet = [&](std::size_t index, const Lamp& lamp, const LightSample& met) {
            float share = 0.0f;  // of the reflected light, this sample's
            float density = 0.0f;
            if (lamp.is_asked(grid.depth)) {
                if (!meets_lamps) return;
                const LampRate rate = choices.rate_of(index, point.sample_count);
                density = point.meeting_density(wo);
                const float sampled = static_cast<float>(rate.samples) * met.pdf * rate.mean;
                share = power_share(density, sampled) / density;
            } else {
                // Cycles asks one of all lamps each time, a world that varies among them.
                const float lamps = set.places + (world.has_density() ? 1.0f : 0.0f);
                density = point.all_density(wo);
                share = point.left_to_lobes(wo, met.pdf / lamps) / density;
            }
            if (!(density > 0.0f)) return;  // by rounding, at a lobe's rim
            const BsdfValue weight = lamp.apply(value, grid.in_medium) * Vec3f(share);
            if (total(weight) != Vec3f(0.0f))
                add_met(set, grid,
                        {&point, &lamp, place, met, weight, type, sign,
                         grid.tells_met() ? density / likely : 1.0f});
        };
        set.meet(grid, point, place, wo, meet);
    }
}

void DirectLight::Impl::mirror(LitGrid& grid, const LitPoint& point, std::size_t lobe) const {
    Vec3f wo, share;
    if (!point.bsdf.deflect(lobe, wo, share)) return;
    const int count = set.varies ? point.sample_count : 1;
    const float chance = point.chance(lobe) / static_cast<float>(count);  // of one of them
    BsdfValue value;
    value.part(point.bsdf.part(lobe)) = share / static_cast<float>(count);
    const SobolPoints sequence = grid.sequence(point, 1 + point.bsdf.index(lobe), count);
    const RayType type = kSharp.of(point.bsdf.part(lobe));
    // What neighbours see in a mirror is filtered together.
    const bool carries_world = grid.placed && grid.carries_world();
    Vec3f open(0.0f);
    for (int s = 0; s < count; ++s) {
        const LitPlace place = set.place_at(point, sequence.third(static_cast<std::uint32_t>(s)));
        const auto meet = [&](std::size_t, const Lamp& lamp, const LightSample& met) {
            const BsdfValue weight = lamp.apply(value, grid.in_medium);
            if (total(weight) != Vec3f(0.0f))
                add_met(set, grid,
                        {&point, &lamp, place, met, weight, type, LitGrid::sign(s, count),
                         1.0f / chance});
        };
        set.meet(grid, point, place, wo, meet);
        if (grid.leaving) {
            leave(set, grid, point, set.ray(point, place, wo, kInfinity, type), value,
                  {chance, kInfinity},
                  point.place * static_cast<std::uint32_t>(count) + static_cast<std::uint32_t>(s),
                  carries_world ? world.ahead_of_mirror() : WorldAhead());
        }
        if (world.shines() && !carries_world) open += set.occlusion(grid, point, place, wo, type);
    }
    grid.look(grid.sharp, point.index, wo, value * open, 0.0f);
}

/// Dimensions are numbered by the closure's lobes, which are the same for all points: 0 the
/// world's, then the lobes', then the choice's where there is one, then the lamps'
/// (lobe_choice_dimension()).
void DirectLight::Impl::light_points(LitGrid& grid, const std::vector<LitPoint>& points,
                                     std::size_t lobe_count, std::vector<LampSight>* sights) const {
    const std::size_t first = 1 + lobe_count;
    LampChoices choices(set, grid, finer_by_corner);
    if (grid.wants_ways_alone()) {
        for (const LitPoint& point : points)
            for (std::size_t k = 0; k < point.bsdf.lobe_count(); ++k)
                if (!point.bsdf.is_sharp(k)) sample_lobe(grid, point, k, choices);
        return;
    }
    light_by_all(set, grid, points, first + (choices.empty() ? 0 : 1), progress, sights);
    if (choices.empty()) {
        for (const LitPoint& point : points) sample_rest(grid, point, choices);
        return;
    }
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    if (!grid.placed)
        std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return points[i].place; });
    LightReceiver receiver(grid.receives);
    std::vector<LampTurn> turns;
    for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
        receiver.clear();
        const std::uint32_t square = points[order[begin]].place / kSharing;
        for (end = begin; end < order.size(); ++end) {
            const LitPoint& point = points[order[end]];
            if (end > begin && (grid.placed || point.place / kSharing != square)) break;
            receiver.add(point.reach(), point.bsdf);
        }
        choices.aim(receiver, points[order[begin]].sample_count);
        for (std::size_t i = begin; i < end; ++i) {
            const LitPoint& point = points[order[i]];
            choices.choose(grid.sequence(point, first, 1)(0), order[i], turns);
            sample_rest(grid, point, choices);
        }
    }
    grid.light_nodes += choices.nodes_seen();
    grid.lamps_chosen += turns.size();
    light_by_chosen(set, grid, points, std::move(turns), first + 1 + set.everywhere, progress);
}

/// What lamps do not tell.
void DirectLight::Impl::sample_rest(LitGrid& grid, const LitPoint& point,
                                    const LampChoices& choices) const {
    progress.check();
    world.sample(set, grid, point);
    for (std::size_t k = 0; k < point.bsdf.lobe_count(); ++k) {
        if (point.bsdf.is_sharp(k))
            mirror(grid, point, k);
        else
            sample_lobe(grid, point, k, choices);
    }
}

LitGrid DirectLight::Impl::lit_grid(const ShadingPoints& points, const SurfaceClosure& closure,
                                    const GridKey& key, std::vector<Vec3f>& radiance) const {
    LitGrid grid{.radiance = radiance};
    grid.seed = sequence_seed(points, key, scene.options.seed);
    grid.placed = !points.places.empty();
    grid.columns = points.columns;
    grid.alone = points.alone || points.round || points.whole_faces;
    grid.in_medium = closure.lobes.front().kind == LobeKind::Phase;
    grid.depth = static_cast<int>(points.depth % ShadingPoints::kDepths);
    grid.receives = receives(key);
    return grid;
}

void DirectLight::Impl::count(const LitGrid& grid) const {
    statistics.add(Counter::RaysShadow, grid.shadow_rays);
    statistics.add(Counter::RaysOcclusion, grid.occlusion_rays);
    statistics.add(Counter::LampsChosen, grid.lamps_chosen);
    statistics.add(Counter::LightNodes, grid.light_nodes);
}

DirectLight::DirectLight(const Scene& scene, WorldEvaluator world, Statistics& statistics,
                         Report& report, const Progress& progress, RayMaterials materials,
                         std::shared_ptr<GeometryCache> geometries,
                         std::shared_ptr<PersistentRays> rays, const Displacement* displacement,
                         const LightPatterns& patterns, bool nodes_ask_rays)
    : m_impl(std::make_unique<Impl>(scene, std::move(world), statistics, report, progress,
                                    std::move(materials), std::move(geometries), std::move(rays),
                                    displacement, patterns, nodes_ask_rays)) {}

DirectLight::~DirectLight() = default;

const RayScene* DirectLight::rays() const {
    return m_impl->set.rays.get();
}

const std::vector<LightAnchor>& DirectLight::anchors() const {
    return m_impl->anchors;
}

void DirectLight::world_radiance(const std::vector<Vec3f>& directions, const PartRays& types,
                                 std::vector<BsdfValue>& out) const {
    m_impl->world.radiance(directions, types, out);
}

const LampFaces& DirectLight::lamp_faces() const {
    return m_impl->shining;
}

bool DirectLight::varies() const {
    return m_impl->set.varies;
}

int DirectLight::sample_count(float share) const {
    return m_impl->set.sample_count(share);
}

void DirectLight::lift(ShadingPoints& points, const GridKey& key) const {
    const RayScene* rays = m_impl->set.rays.get();
    if (!rays || !rays->is_displaced(key)) return;
    points.ray_offset.resize(points.count, Vec3f(0.0f));
    const auto clear = [&](const std::vector<Vec3f>& places) {
        const std::vector<float> heights = rays->heights_over(
            key, {places, points.geometric_normal, points.backfacing, points.times});
        for (std::size_t i = 0; i < points.count; ++i) {
            const float lifted = glm::dot(points.ray_offset[i], points.geometric_normal[i]);
            if (heights[i] > lifted)
                points.ray_offset[i] += (heights[i] - lifted) * points.geometric_normal[i];
        }
    };
    clear(points.p);
    if (!points.edges) return;
    // Rays that look for surfaces start beside the border: a step along the tangent, which leads
    // below what is hollow.
    std::vector<Vec3f> beside(points.count, Vec3f(NAN));  // as yet none: not traced
    for (std::size_t i = 0; i < points.count; ++i) {
        const Vec3f step = inwards(points, i);
        if (step != Vec3f(0.0f)) beside[i] = points.p[i] + step;
    }
    clear(beside);
}

std::vector<Vec3f> DirectLight::reflect(const ShadingPoints& points, const SurfaceClosure& closure,
                                        const GridKey& key, ReflectionParts* parts,
                                        const PointPaths& paths, std::vector<float>* noise,
                                        LeavingRays* leaving,
                                        std::vector<LampSight>* sights) const {
    std::vector<Vec3f> radiance(points.count, Vec3f(0.0f));
    if (noise) noise->assign(points.count, 0.0f);
    if (parts) parts->resize(points.count);
    if (leaving) leaving->met.clear();
    const bool dark = m_impl->set.lamps.empty() && !m_impl->world.shines();
    if (closure.lobes.empty() || (dark && !parts && !leaving)) return radiance;
    LitGrid grid = m_impl->lit_grid(points, closure, key, radiance);
    grid.parts = parts;
    grid.by_lobe = m_impl->world.by_lobe();
    grid.balance = noise;
    grid.leaving = leaving;
    LitSets sets = lit_points(m_impl->set, grid, points, closure, key, paths, dark && !leaving);
    for (auto& [receives, lit] : sets) {
        grid.receives = receives;
        place_lobe_samples(lit, closure.lobes.size(), grid.placed);
        m_impl->light_points(grid, lit, closure.lobes.size(), sets.size() == 1 ? sights : nullptr);
    }
    deliver_met(grid);
    m_impl->world.deliver(grid);
    m_impl->count(grid);
    return radiance;
}

std::vector<std::uint8_t> DirectLight::highlights(const Grid& grid, const ShadingPoints& points,
                                                  const SurfaceClosure& closure) const {
    return mirrored_lamps(m_impl->set, m_impl->receives(grid.key), grid, points, closure);
}

bool DirectLight::highlights_may_pass(const SurfaceClosure& closure, const GridKey& key) const {
    return may_mirror_lamps(m_impl->set, m_impl->receives(key), closure);
}

bool DirectLight::highlights_pass(const ShadingPoints& points, const SurfaceClosure& closure,
                                  const GridKey& key) const {
    return lamps_pass(m_impl->set, m_impl->receives(key), points, closure);
}

std::vector<LampSight> DirectLight::see(const ShadingPoints& points, const GridKey& key,
                                        std::span<const LampSight> lamps) const {
    SurfaceClosure white;
    Lobe& lobe = white.lobes.emplace_back();
    lobe.weight.assign(points.count, Vec3f(1.0f));
    lobe.normal = points.normal;
    lobe.roughness.assign(points.count, 0.0f);
    std::vector<Vec3f> radiance(points.count, Vec3f(0.0f));
    LitGrid grid = m_impl->lit_grid(points, white, key, radiance);
    const PointPaths none;
    const LitSets sets = lit_points(m_impl->set, grid, points, white, key, none, false);
    std::vector<LampSight> sights;
    for (const auto& [receives, lit] : sets) {
        grid.receives = receives;
        sights = see_again(m_impl->set, grid, lit, lamps, 1 + white.lobes.size(), m_impl->progress);
    }
    m_impl->count(grid);
    return sights;
}

}  // namespace granita
