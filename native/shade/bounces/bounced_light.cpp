// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/bounced_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/sorted_runs.h"
#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/bounces/passed_media.h"
#include "shade/bounces/seen_world.h"
#include "shade/bounces/way_choice.h"
#include "shade/bounces/white_light.h"
#include "shade/nodes/surface_run.h"
#include "shade/volumes/scatter_points.h"

namespace granita {
namespace {

/// What chances decide about.
enum Decision : std::uint64_t { kWay = 1, kGoesOn = 2 };

}  // namespace

/// The ways of a batch of points, a bounce at a time.
class BouncedLight::Wave {
  public:
    Wave(const BouncedLight& light, const std::vector<LobeRay>& leaving, bool is_scattered,
         GatheredLight& gathered)
        : m_light(light),
          m_limits(light.m_scene.options.bounces),
          m_gathered(gathered),
          m_points(light.m_scene, *light.m_direct.rays(), &light.m_progress) {
        if (light.m_volumes)
            m_media.emplace(*light.m_volumes, m_limits, light.m_scene.options.seed);
        const bool sees_world =
            std::ranges::any_of(leaving, [](const LobeRay& ray) { return ray.world.shines(); });
        m_gathered.world.resize(sees_world ? gathered.diffuse.size() : 0);
        m_gathered.world_balance.resize(m_gathered.world.size(), Vec2f(0.0f));
        for (const LobeRay& ray : leaving) follow(BouncedPath::leaving(ray), is_scattered);
        m_paths.swap(m_next);
    }

    void run() {
        bool is_first = true;
        while (!m_paths.empty()) {
            m_light.m_progress.check();
            trace();
            if (m_media) pass_media();
            see_world();
            weigh_met();
            if (std::exchange(is_first, false)) note_near();
            split();
            shade();
            m_paths.swap(m_next);
            m_next.clear();
        }
        m_light.m_statistics.add(Counter::RaysBounce, m_rays_traced);
        m_light.m_statistics.add(Counter::HitsShaded, m_hits_shaded);
    }

  private:
    /// Hits that are shaded at once: a step of a program over more would be too long for a cancel.
    static constexpr std::size_t kBatch = 1024;
    /// Where a way is, from which it goes on: on a surface, or in a medium, where there is no hit.
    struct End {
        const RayHit* hit;
        const ShadingPoints* points;
        std::size_t point;
        float distance;
    };
    using Scattering = PassedMedia::Scattering;

    /// Uniform in [0, 1), of a way's place among the samples and how far it has come.
    float chance(const BouncedPath& path, Decision of) const {
        const auto at = static_cast<std::uint64_t>(path.depth) << 48 |
                        static_cast<std::uint64_t>(path.passed) << 32 | path.next.place;
        const std::uint64_t salt = mix_bits(m_light.m_scene.options.seed + of);
        return unit_float(mix_bits(mix_bits(at) + salt));
    }

    /// Keeps the way for the next wave, unless it may go no further.
    void follow(BouncedPath path, bool is_scattered) {
        path.count_bounce(is_scattered);
        if (is_within_limits(path)) m_next.push_back(path);
    }

    /// Rays one further than the limits bring the world, and what surfaces emit, alone.
    bool is_within_limits(const BouncedPath& path) const {
        return path.is_within(m_limits, m_light.m_any_shines || path.next.world.shines() ? 1 : 0);
    }
    bool is_lit(const BouncedPath& path) const { return path.is_lit(m_limits); }

    /// Of what the first rays meet: the light it brings varies as it is near, however little it is.
    void note_near() {
        std::vector<float> near(m_paths.size(), std::numeric_limits<float>::infinity());
        for (const RayScene::Met& one : m_met) near[one.ray] = one.hit.distance;
        for (std::size_t i = 0; i < m_paths.size(); ++i) {
            const BouncedPath& path = m_paths[i];
            if (path.kind != BouncedPath::Kind::Diffuse) continue;
            // What lies just out of these rays' sight may darken the next point.
            if (m_meets_nothing[i] && path.is_occlusion(m_limits))
                near[i] = m_limits.occlusion_distance;
            if (m_media) near[i] = std::min(near[i], m_media->first_light(i));
            if (std::isinf(near[i])) continue;
            m_gathered.nearness[path.next.point] += 1.0f / std::max(near[i], 1e-30f);
            ++m_gathered.met[path.next.point];
        }
    }

    void trace() {
        m_rays.clear();
        for (const BouncedPath& path : m_paths) {
            m_rays.push_back(path.next.ray);
            if (path.is_occlusion(m_limits))
                m_rays.back().distance = std::max(m_limits.occlusion_distance - path.length, 0.0f);
        }
        m_rays_traced += m_rays.size();
        m_light.m_direct.rays()->nearest(m_rays, m_met);
        m_meets_nothing.assign(m_paths.size(), 1);
        if (m_limits.occlusion_added > 0.0f) add_occlusion();
        for (const RayScene::Met& one : m_met) m_meets_nothing[one.ray] = 0;
    }

    void add_occlusion() {
        const std::vector<Vec3f> light =
            white_light(*m_light.m_direct.rays(), m_paths, m_rays, m_limits);
        for (std::size_t i = 0; i < m_paths.size(); ++i) {
            const LobeRay& ray = m_paths[i].next;
            if (m_paths[i].depth > 1)
                bring(m_paths[i], light[i], Vec3f(0.0f));
            else if (is_finite(ray.weight * light[i]))
                m_gathered.diffuse[ray.point] += ray.weight * light[i];
        }
    }

    /// Light of the world where nothing was met: of the first rays it is what reaches the points
    /// straight, not over other surfaces.
    void see_world() {
        std::vector<BsdfValue> seen = seen_world(m_light.m_direct, m_paths, m_meets_nothing);
        for (std::size_t i = 0; i < m_paths.size(); ++i) {
            const BouncedPath& path = m_paths[i];
            if (path.is_occlusion(m_limits)) seen[i] = seen[i] * Vec3f(m_limits.occlusion_factor);
            if (total(seen[i]) == Vec3f(0.0f)) continue;
            if (path.depth > 1) {
                bring(path, total(seen[i]), Vec3f(0.0f));
                continue;
            }
            const LobeRay& ray = path.next;
            const BsdfValue light = seen[i] * ray.weight;
            if (!is_finite(total(light))) continue;
            m_gathered.world[ray.point] += light;
            m_gathered.world_balance[ray.point] +=
                ray.world.sign *
                Vec2f(luminance(light.diffuse), luminance(light.glossy + light.transmission));
        }
    }

    /// Leaves what chance has not chosen, and what would bring nothing, unshaded.
    void weigh_met() {
        std::erase_if(m_met, [&](const RayScene::Met& one) {
            BouncedPath& path = m_paths[one.ray];
            path.next.weight *= path.met_weight;
            const bool brings = is_lit(path) || m_light.m_any_shines || passes(one.hit, path);
            return path.met_weight == 0.0f || !brings;
        });
    }

    /// Makes what mirrors show a way for each light sample of its point, as far as it is followed
    /// for all of it, where chance comes in: one alone would be its point's only sample of the
    /// lamps there, and of all that bounces.
    void split() {
        const std::size_t met = m_met.size();
        for (std::size_t i = 0; i < met; ++i) {
            BouncedPath& path = m_paths[m_met[i].ray];
            if (path.splits == 1 || path.kind != BouncedPath::Kind::Mirrored || !is_lit(path))
                continue;
            const std::int32_t material = m_met[i].hit.material;
            if (!m_light.m_hits.surface(material, path.next.ray.type).radiance.spreads()) continue;
            path.split();
            BouncedPath other = path;
            other.is_first = false;
            for (int k = 1; k < other.copies; ++k) {
                ++other.next.place;
                RayScene::Met same = m_met[i];
                same.ray = static_cast<std::uint32_t>(m_paths.size());
                m_met.push_back(same);
                m_paths.push_back(other);
            }
        }
    }

    bool passes(const RayHit& hit, const BouncedPath& path) const {
        return !m_light.m_hits.surface(hit.material, path.next.ray.type)
                    .transparency.is(Vec3f(0.0f));
    }

    /// Of what fills the ways to the surfaces that were met.
    void pass_media() {
        m_media->find(m_met, m_rays);
        for (std::size_t i = 0; i < m_paths.size(); ++i) {
            const Vec3f& emitted = m_media->emitted()[i];
            if (emitted != Vec3f(0.0f))
                bring(m_paths[i], Vec3f(0.0f), emitted * m_paths[i].met_weight);
        }
        m_media->pass(m_rays, m_paths, m_met, m_meets_nothing);
        shade_scattering();
    }

    /// Ways after as many surfaces together.
    void shade_scattering() {
        const std::span<const Scattering> all = m_media->scattering();
        for (std::size_t begin = 0, end; begin < all.size(); begin = end) {
            const int depth = m_paths[all[begin].path].depth;
            for (end = begin; end < all.size() && m_paths[all[end].path].depth == depth;) ++end;
            shade_scattering(all.subspan(begin, end - begin), depth);
        }
    }

    void shade_scattering(std::span<const Scattering> batch, int depth) {
        m_hits_shaded += batch.size();
        ScatterPoints places(static_cast<std::uint32_t>(depth),
                             m_light.m_scene.options.light_samples,
                             m_light.m_volumes->phase_kinds());
        for (const Scattering& one : batch)
            places.add(m_rays[one.path], one.place, m_paths[one.path].next.place, one.u);
        places.finish();
        m_leaving.rays.clear();
        const std::vector<Vec3f> light = m_light.m_direct.reflect(
            places.points(), places.closure(), {}, nullptr, {}, nullptr, &m_leaving);
        const std::vector<Vec3f> met = held_met(
            batch.size(), [&](std::size_t k) -> const auto& { return m_paths[batch[k].path]; });
        for (std::size_t k = 0; k < batch.size(); ++k)
            bring(m_paths[batch[k].path], light[k], Vec3f(0.0f), met[k]);
        std::ranges::stable_sort(m_leaving.rays, {}, &LobeRay::point);
        auto candidate = m_leaving.rays.begin();
        for (std::uint32_t k = 0; k < batch.size(); ++k) {
            const auto begin = candidate;
            while (candidate != m_leaving.rays.end() && candidate->point == k) ++candidate;
            choose({begin, candidate}, m_paths[batch[k].path], batch[k].place.distance);
        }
    }

    /// Surfaces by program and instance.  The order of a point's own ways does not depend on what
    /// else is in the batch.
    void shade() {
        const auto key = [&](std::uint32_t i) {
            const BouncedPath& path = m_paths[m_met[i].ray];
            return std::tuple(m_met[i].hit.instance, m_met[i].hit.material,
                              static_cast<int>(path.next.ray.type), path.depth, is_lit(path),
                              path.was_diffuse);
        };
        std::vector<MetPath> batch;
        const auto shade_run = [&](std::span<const std::uint32_t> run) {
            batch.clear();
            for (const std::uint32_t i : run)
                batch.push_back(met_by(m_paths[m_met[i].ray], m_met[i].hit, m_met[i].frame()));
            shade(batch);
        };
        for_sorted_runs(m_order, m_met.size(), key, shade_run, kBatch);
    }

    void shade(const std::vector<MetPath>& batch) {
        m_hits_shaded += batch.size();
        const BouncedPath& first = *batch.front().path;
        const RayHit& hit = *batch.front().hit;
        const CompiledSurface& surface = m_light.m_hits.surface(hit.material, first.next.ray.type);
        m_points.fill(batch, surface.requests, static_cast<std::uint32_t>(first.depth));
        const Instance& instance = m_light.m_scene.instances[hit.instance];
        const GridKey key{instance.key};
        m_light.m_direct.lift(m_points.points(), key);
        SurfaceRun ran(surface.radiance, m_points.input());
        SurfaceClosure closure = ran.take_closure();
        const bool has_body = m_light.m_scatter && m_light.m_direct.rays()->has_body(key);
        draw_as_diffuse(closure, has_body, first.was_diffuse);
        tame(batch, closure);
        std::vector<Vec3f> light(batch.size(), Vec3f(0.0f)), emitted = light;
        m_leaving.rays.clear();
        m_leaving.met.clear();
        if (is_lit(first)) {
            light = m_light.m_direct.reflect(ran.points(), closure, key, nullptr, {}, nullptr,
                                             &m_leaving);
            if (!closure.subsurface.empty())
                m_light.m_scatter(ran.points(), closure, key, light, m_leaving.rays);
        }
        for (std::size_t i = 0; i < closure.emission.size(); ++i)
            if (!m_light.is_lamp(*batch[i].hit) &&
                in_light_set(batch[i].path->next.receives, instance.receiver_set))
                emitted[i] = closure.emission[i];
        const std::vector<Vec3f> met = held_met(
            batch.size(), [&](std::size_t i) -> const auto& { return *batch[i].path; });
        for (std::size_t i = 0; i < batch.size(); ++i)
            bring(*batch[i].path, light[i], emitted[i], met[i]);
        go_on(batch, ran.points(), closure);
    }

    /// Glossy lobes that would throw noise onto diffuse ones: left out, or, as by Cycles' Filter
    /// Glossy, blurred as much as the way is improbable.
    void tame(const std::vector<MetPath>& batch, SurfaceClosure& closure) const {
        const auto throws_no_caustics = [&](const Lobe& lobe) {
            switch (lobe.kind) {
                case LobeKind::Glossy:
                case LobeKind::GlossyToon:
                    return !m_limits.reflective_caustics;
                case LobeKind::Refraction:
                case LobeKind::ThinGlass:
                    return !m_limits.refractive_caustics;
                default:
                    return false;  // hair always does
            }
        };
        // Cycles asks what sent the ray, not what was before.
        if (is_diffuse(batch.front().path->next.ray.type))
            std::erase_if(closure.lobes, throws_no_caustics);
        if (m_limits.filter_glossy == 0.0f) return;
        for (Lobe& lobe : closure.lobes) {
            if (!is_blurred(lobe.kind) || lobe.distribution == Distribution::Sharp) continue;
            for (std::size_t i = 0; i < batch.size(); ++i) {
                const float known = batch[i].path->least_pdf / m_limits.filter_glossy;
                if (known < 1.0f) lobe.roughen(i, 0.5f * std::sqrt(1.0f - known));
            }
        }
    }

    /// What lobes have met of lamps, [count] ways, path_of(i) each.
    template <class PathOf>
    std::vector<Vec3f> held_met(std::size_t count, PathOf path_of) const {
        std::vector<Vec3f> held(count, Vec3f(0.0f));
        for (const MetLight& met : m_leaving.met)
            held[met.point] += path_of(met.point).held(m_limits.clamp, met.light, met.whole);
        return held;
    }

    /// `met`: held_met().  `emitted` by what is met first is no indirect light, and not clamped as
    /// such (Cycles).
    void bring(const BouncedPath& path, const Vec3f& light, const Vec3f& emitted,
               const Vec3f& met = Vec3f(0.0f)) {
        const LobeRay& ray = path.next;
        const bool is_mirrored = path.kind == BouncedPath::Kind::Mirrored;
        const float clamp = m_limits.clamp;
        const Vec3f shining = path.held(path.depth > 1 ? clamp : 0.0f, emitted);
        const Vec3f brought = path.held(clamp, light) + shining + met;
        const Vec3f diffuse = brought * path.diffuse_part;
        m_gathered.diffuse[ray.point] += diffuse;
        (is_mirrored ? m_gathered.mirrored : m_gathered.glossy)[ray.point] += brought - diffuse;
        m_gathered.transmitted[ray.point] += brought * path.transmitted;
        if (path.depth == 1 && !m_gathered.emitted.empty())
            m_gathered.emitted[ray.point] += shining;
    }

    /// One way out of each point, but for mirrors'.
    void go_on(const std::vector<MetPath>& batch, const ShadingPoints& points,
               const SurfaceClosure& closure) {
        std::ranges::stable_sort(m_leaving.rays, {}, &LobeRay::point);
        auto candidate = m_leaving.rays.begin();
        for (std::uint32_t i = 0; i < batch.size(); ++i) {
            const auto begin = candidate;
            while (candidate != m_leaving.rays.end() && candidate->point == i) ++candidate;
            Vec3f through(0.0f);
            const BouncedPath& path = *batch[i].path;
            if (!closure.transparency.empty() && path.passed < m_limits.transparent &&
                is_finite(closure.transparency[i]))
                through = glm::clamp(closure.transparency[i], Vec3f(0.0f), Vec3f(1.0f));
            choose({begin, candidate}, through, path,
                   {batch[i].hit, &points, i, batch[i].hit->distance});
        }
    }

    /// One of the ways out, of a place `distance` metres away in a medium.
    void choose(std::span<const LobeRay> ways, const BouncedPath& path, float distance) {
        choose(ways, Vec3f(0.0f), path, {nullptr, nullptr, 0, distance});
    }

    /// Chance chooses among the ways, then whether what is met brings anything: a ray that meets
    /// nothing brings the world's light anyway.
    void choose(std::span<const LobeRay> ways, const Vec3f& through, const BouncedPath& path,
                const End& end) {
        choose_ways(path, ways, through, chance(path, kWay), m_chosen);
        for (const ChosenWay& way : m_chosen) {
            if (way.is_sure && !path.is_first) continue;
            BouncedPath next = path;
            next.leave_copies(way.is_sure);
            next.sure_part = way.sure_part;
            next.chance = way.chance;
            if (!way.is_sure && path.kind == BouncedPath::Kind::Mirrored)
                next.kind = BouncedPath::Kind::Glossy;
            const WorldAhead& world = way.ray ? way.ray->world : path.next.world;
            next.met_weight = chance(path, kGoesOn) < way.goes_on ? 1.0f / way.goes_on : 0.0f;
            const bool is_asked = world.shines() || m_limits.occlusion_added > 0.0f;
            if (next.met_weight == 0.0f && !is_asked) continue;
            if (way.ray)
                follow(next.sent(*way.ray, way.weight, end.distance), end.hit == nullptr);
            else
                m_next.push_back(next.passing(behind(end), way.weight, end.distance));
        }
    }

    Vec3f behind(const End& end) const {
        const ShadingPoints& points = *end.points;
        const std::uint32_t face = points.faces.empty() ? 0 : points.faces[end.point];
        const RayOffset offset = m_light.m_direct.rays()->ray_offset(
            {m_light.m_scene.instances[end.hit->instance].key, face});
        return offset(end.hit->p, -points.geometric_normal[end.point]);
    }

    const BouncedLight& m_light;
    const Bounces& m_limits;
    GatheredLight& m_gathered;
    HitPoints m_points;
    std::vector<BouncedPath> m_paths, m_next;
    std::vector<Ray> m_rays;
    std::vector<RayScene::Met> m_met;
    std::vector<std::uint8_t> m_meets_nothing;  ///< [paths] whose rays meet nothing
    std::vector<std::uint32_t> m_order;
    LeavingRays m_leaving{.tells_met = true};
    std::vector<ChosenWay> m_chosen;
    std::optional<PassedMedia> m_media;  ///< where there are any
    std::uint64_t m_rays_traced = 0, m_hits_shaded = 0;
};

BouncedLight::BouncedLight(const Scene& scene, const DirectLight& direct, const HitShader& hits,
                           const MaterialEmission& emission, const Volumes* volumes,
                           HitScattering scatter, Statistics& statistics, const Progress& progress)
    : m_scene(scene),
      m_direct(direct),
      m_hits(hits),
      m_emission(emission),
      m_volumes(volumes),
      m_scatter(std::move(scatter)),
      m_any_shines((volumes && volumes->shines()) || scene.options.bounces.occlusion_added > 0.0f),
      m_statistics(statistics),
      m_progress(progress) {
    for (std::size_t i = 0; i < scene.instances.size() && !m_any_shines; ++i) {
        const Instance& instance = scene.instances[i];
        if (!instance.is_seen_by_light() || instance.lifespan.is_empty()) continue;
        const bool are_lamps = direct.lamp_faces().hold_all_of(i);
        m_any_shines = std::ranges::any_of(instance.materials, [&](std::int32_t material) {
            return emission.any(material) && !(are_lamps && emission.is_lamp(material));
        });
    }
}

GatheredLight BouncedLight::gather(const std::vector<LobeRay>& leaving, std::size_t points) const {
    GatheredLight light(points);
    if (!leaving.empty()) Wave(*this, leaving, false, light).run();
    return light;
}

GatheredLight BouncedLight::gather_scattered(const std::vector<LobeRay>& leaving,
                                             std::size_t points) const {
    GatheredLight light(points);
    light.emitted.resize(points, Vec3f(0.0f));
    if (!leaving.empty()) Wave(*this, leaving, true, light).run();
    return light;
}

}  // namespace granita
