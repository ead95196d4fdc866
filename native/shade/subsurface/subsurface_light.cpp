// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/subsurface/subsurface_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/surface_frames.h"
#include "math/luminance.h"
#include "math/normalize_or.h"
#include "math/sampling.h"
#include "shade/bounces/hit_points.h"
#include "shade/lights/grid_samples.h"
#include "shade/lights/leaving_rays.h"
#include "shade/nodes/surface_run.h"
#include "shade/subsurface/entry.h"
#include "shade/subsurface/probe.h"
#include "shade/subsurface/random_walk.h"
#include "shade/subsurface/shared_scattering.h"

namespace granita {
namespace {

/// Of the sequences by which ends are lit: no surface lies so deep.
constexpr std::uint32_t kDepth = 1u << 20;
/// Steps of a lattice: light that goes no farther varies between its points.
constexpr float kCells = 2.0f;
constexpr float kLeastAlbedo = 1e-6f;
/// Of one scattering.
constexpr float kLeastScattered = 0.2f;

}  // namespace

/// The ways of a batch of points.
class SubsurfaceLight::Batch {
  public:
    Batch(const SubsurfaceLight& light, const ShadingPoints& points, const GridKey& key,
          const PointPaths& paths, ReflectionParts* parts, bool follows)
        : m_light(light),
          m_rays(*light.m_direct.rays()),
          m_points(points),
          m_key(key),
          m_paths(paths),
          m_parts(parts),
          m_follows(follows),
          m_seed(sequence_seed(points, key, light.m_scene.options.seed)),
          m_direct(points.count, Vec3f(0.0f)),
          m_gone{m_direct, m_direct} {
        const auto samples = static_cast<float>(light.m_scene.options.light_samples);
        m_count = std::max(1, static_cast<int>(std::lround(points.share * samples)));
        m_front = points.columns > 0 && std::ranges::count(points.backfacing, 0) > 0;
    }

    void scatter(const std::vector<SubsurfaceLobe>& lobes) {
        for (std::size_t k = 0; k < lobes.size(); ++k) scatter(lobes[k], k);
    }

    /// [points] what has come straight.
    std::vector<Vec3f>& direct() { return m_direct; }
    const WaysGone& gone() const { return m_gone; }
    /// Of points, as their lobes' rays.
    const std::vector<LobeRay>& leaving() const { return m_leaving; }

  private:
    void scatter(const SubsurfaceLobe& lobe, std::size_t index) {
        m_exits.clear();
        m_ways.clear();
        const std::uint64_t seed = mix_bits(m_seed + 0x9e3779b97f4a7c15ULL * (index + 1));
        const SobolPoints entries = sequence(seed), times = sequence(mix_bits(seed)),
                          places = sequence(mix_bits(~seed));
        m_body = m_rays.body(m_key, m_light.m_scene.options.frame_time);
        for (std::size_t i = 0; i < m_points.count; ++i) {
            if (lobe.weight[i] == Vec3f(0.0f)) continue;
            m_light.m_progress.check();
            const bool varies_in_cell =
                m_points.columns > 0 && lobe.nearest(i) < kCells * width_of(m_points, i);
            const std::uint32_t first =
                place_in_sequence(m_points, i) * static_cast<std::uint32_t>(m_count);
            for (std::uint32_t s = first; s < first + static_cast<std::uint32_t>(m_count); ++s) {
                if (m_light.m_direct.varies()) move_to(time_at(i, times(s).x));
                if (s == first || varies_in_cell || m_light.m_direct.varies())
                    stand_on(i, varies_in_cell ? cell_at(i, places(s)) : Vec2f(0.0f));
                if (lobe.walks)
                    walk_from(lobe, i, s, entries(s), mix_bits(seed ^ mix_bits(s + 1ULL)));
                else
                    probe_from(lobe, i, s, entries(s));
            }
        }
        light_exits(lobe.burley);
    }

    /// What has a place in the frame's sequences already is not tied to that: to the direction in
    /// which it was met.
    SobolPoints sequence(std::uint64_t seed) const {
        const SobolPoints made(seed);
        return m_points.places.empty() ? made : made.shuffled(mix_bits(seed));
    }

    /// One at which the point is seen: of samples at which they stand where they are.
    float time_at(std::size_t i, float uniform) const {
        if (!m_points.times.empty() && m_points.times[i] >= 0.0f) return m_points.times[i];
        if (!m_points.visible_times.empty() && !m_points.visible_times[i].empty())
            return one_of(m_points.visible_times[i], uniform);
        const Vec2f exposed = m_light.m_shutter.exposed(m_paths.lifespan());
        return m_light.m_shutter.time(exposed.x + uniform * (exposed.y - exposed.x));
    }

    void move_to(float time) {
        if (time != m_body.time) m_body = m_rays.body(m_key, time);
    }

    /// Where a lattice bends away from the viewer, its points that are behind count as those
    /// before: of a body they are not seen, but what is seen between them and those is.
    bool is_turned(std::size_t i) const { return m_front && m_points.backfacing[i]; }
    Vec3f faced(std::size_t i, const Vec3f& normal) const {
        return is_turned(i) ? -normal : normal;
    }

    /// Steps of a lattice from a point to a place in what it stands for: up to halfway to its
    /// neighbours.
    Vec2f cell_at(std::size_t i, const Vec2f& uniform) const {
        const std::size_t columns = m_points.columns, rows = m_points.count / columns;
        const auto step = [](std::size_t at, std::size_t count, float u) {
            const float from = at > 0 ? -0.5f : 0.0f, to = at + 1 < count ? 0.5f : 0.0f;
            return from + u * (to - from);
        };
        return {step(i % columns, columns, uniform.x), step(i / columns, rows, uniform.y)};
    }

    /// Puts a point, as many steps aside, onto what rays meet of its mesh, from which coarse points
    /// of curved or small faces may lie as far as light goes.
    void stand_on(std::size_t i, const Vec2f& aside) {
        m_p = m_points.p[i];
        m_normal = m_points.geometric_normal[i];
        if (m_paths.moves()) {
            const PointPaths::Place there = m_paths.at(i, m_body.time);
            m_p = there.p;
            m_normal = there.normal;
        }
        m_normal = faced(i, m_normal);
        const std::uint32_t face = m_points.faces.empty() ? m_key.face : m_points.faces[i];
        RayOffset offset = m_rays.ray_offset({m_key.instance, face});
        if (is_hit()) {
            offset.error = 0.0f;
            m_rounding = offset.length(m_p);
            return;
        }
        const float step = width_of(m_points, i);
        const float height = step + offset.length(m_p);
        RayScene::Met met{};
        bool is_on = step_aside(i, aside, height);
        if (!is_on) {
            m_p += inwards(m_points, i);
            is_on = is_small() ? drop_near(i, height, met) : drop(height, met);
        }
        if (is_on) offset.error = 0.0f;
        m_rounding = offset.length(m_p);
    }

    /// Onto the mesh, as many steps of the lattice aside, where it faces as the point does.
    bool step_aside(std::size_t i, const Vec2f& aside, float height) {
        constexpr float kLeastCosine = 0.5f;
        if (aside == Vec2f(0.0f)) return false;
        const Vec3f corner = m_p;
        m_p += aside.x * m_points.dp_du[i] + aside.y * m_points.dp_dv[i];
        RayScene::Met met{};
        const bool is_there = drop(height, met);
        const float cosine = is_there ? glm::dot(met.hit.normal, m_normal) : 0.0f;
        if (std::abs(cosine) < kLeastCosine) {
            m_p = corner;
            return false;
        }
        m_normal = cosine < 0.0f ? -met.hit.normal : met.hit.normal;
        return true;
    }

    /// Whether points are where rays have met the mesh.
    bool is_hit() const { return m_points.depth > 0; }

    /// Whether points are corners of small faces; not means of some, nor samples.
    bool is_small() const {
        return m_points.columns == 0 && !m_points.faces.empty() && m_points.places.empty();
    }

    /// Points of small faces are their corners, from which light would start beside the body: what
    /// they stand for is around a face's middle, of the point's own if one of the rays down beside
    /// it meets that.
    bool drop_near(std::size_t i, float height, RayScene::Met& met) {
        constexpr float kAside = 0.05f, kInwards = 0.35f;  // of a micropolygon
        constexpr Vec2f kWays[] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
        const Vec3f corner = m_p;
        bool any = false;
        for (const Vec2f& way : kWays) {
            m_p = corner + kAside * (way.x * m_points.dp_du[i] + way.y * m_points.dp_dv[i]);
            RayScene::Met beside{};
            if (!drop(height, beside)) continue;
            const bool is_own = beside.hit.patch->face == m_points.faces[i];
            if (is_own || !any) met = beside;
            any = true;
            if (is_own) break;
        }
        m_p = any ? met.hit.p : corner;
        if (!any) return false;
        // Halfway, of larger faces no more than a part of a micropolygon: shadows stay in place.
        const Vec3f way = 0.5f * to_middle(met);
        const float most = kInwards * width_of(m_points, i), length = glm::length(way);
        m_p += length > most ? way * (most / length) : way;
        if (!drop(height, met)) m_p = met.hit.p;
        return true;
    }

    /// Onto what lies under, or no more than a height above, the point.
    bool drop(float height, RayScene::Met& met) {
        const Ray down{m_p + height * m_normal, -m_normal, 2.0f * height, m_body.time};
        if (!m_rays.nearest(m_body, down, met)) return false;
        m_p = met.hit.p;
        return true;
    }

    /// From a place on a face.
    Vec3f to_middle(const RayScene::Met& met) const {
        static thread_local SurfaceFrames there;
        const RayHit& hit = met.hit;
        find_frames(*hit.geometry, *hit.patch, {&hit.uv, 1}, hit.geometry->at(m_body.time), there);
        const Vec2d way = middle_of(hit.patch->kind) - hit.uv;
        return met.frame().world_from_object * Vec3f(way.x * there.su[0] + way.y * there.sv[0]);
    }

    void walk_from(const SubsurfaceLobe& lobe, std::size_t i, std::uint32_t sample, const Vec2f& u,
                   std::uint64_t seed) {
        WalkStart start;
        start.normal = m_normal;
        start.seed = seed;
        const Vec3f normal = faced(i, lobe.normal[i]);
        Vec3f view = m_points.view[i];
        if (is_turned(i)) view -= 2.0f * glm::dot(view, normal) * normal;
        if (!enter(lobe, i, normal, view, u, start.direction) ||
            !(glm::dot(m_normal, start.direction) < 0.0f))
            return;
        start.p = m_p;
        start.rounding = m_rounding;
        ScatteringMedium medium(lobe.albedo[i], lobe.radius[i], lobe.anisotropy[i]);
        // The way itself takes on the albedo.
        Vec3f weight = lobe.weight[i] / glm::max(lobe.albedo[i], Vec3f(kLeastAlbedo)) /
                       static_cast<float>(m_count);
        // As Cycles: dark channels scatter more, of less light.  What passes thin walls unscattered
        // would be all the brighter, the darker a colour is: fifty times that of .02.
        for (int c = 0; c < 3; ++c) {
            if (medium.albedo[c] >= kLeastScattered) continue;
            weight[c] *= medium.albedo[c] / kLeastScattered;
            medium.albedo[c] = kLeastScattered;
        }
        RayScene::Met exit{};
        if (!walk(m_rays, m_body, medium, start, weight, exit)) return;
        exit.hit.direction = -exit.hit.direction;  // as if it were seen from outside
        add_exit(i, sample, weight, exit);
    }

    void probe_from(const SubsurfaceLobe& lobe, std::size_t i, std::uint32_t sample,
                    const Vec2f& u) {
        probe(m_rays, m_body, BurleyProfile(lobe.radius[i]), m_p, m_normal, m_rounding, u,
              m_probed);
        for (Probed& met : m_probed) {
            // On the side of the mesh on which the point itself is seen.
            RayHit& hit = met.met.hit;
            const bool from_behind = m_points.backfacing[i] && !is_turned(i);
            hit.direction = from_behind ? hit.normal : -hit.normal;
            add_exit(i, sample, lobe.weight[i] * met.weight / static_cast<float>(m_count), met.met);
        }
    }

    void add_exit(std::size_t point, std::uint32_t place, const Vec3f& weight,
                  RayScene::Met& exit) {
        exit.hit.distance = 0.0f;
        const Vec3f way_there = exit.hit.p - m_p;
        const float aside = glm::length(way_there - glm::dot(way_there, m_normal) * m_normal);
        m_gone.weight[point] += weight;
        m_gone.along[point] += weight * aside;
        m_exits.push_back(exit);
        BouncedPath& way = m_ways.emplace_back();
        way.width = width_of(m_points, point);
        way.seen = is_hit() ? m_points.seen_from[point] : glm::length(m_points.p[point]);
        way.next.ray.time = m_body.time;
        way.next.weight = weight;
        way.next.point = static_cast<std::uint32_t>(point);
        // As rays of lobes: a part of the sequences for each grid.
        const auto first = m_points.places.empty() ? static_cast<std::uint32_t>(m_seed) << 14 : 0u;
        way.next.place = first + place;
    }

    /// By material where any bends its normals, else all at once.
    void light_exits(bool burley) {
        std::vector<std::uint32_t> order(m_exits.size());
        std::iota(order.begin(), order.end(), 0u);
        const auto surface_at = [&](std::uint32_t k) {
            return m_light.m_bent(m_exits[k].hit.material);
        };
        std::ranges::stable_sort(order, {}, [&](std::uint32_t k) {
            return surface_at(k) ? m_exits[k].hit.material
                                 : std::numeric_limits<std::int32_t>::min();
        });
        std::vector<std::uint32_t> batch;
        for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
            const CompiledSurface* surface = surface_at(order[begin]);
            batch.clear();
            for (end = begin; end < order.size() && surface_at(order[end]) == surface; ++end)
                batch.push_back(order[end]);
            light_batch(batch, surface, burley);
        }
    }

    /// `surface`: bends the normals of these exits, or nullptr.
    void light_batch(const std::vector<std::uint32_t>& batch, const CompiledSurface* surface,
                     bool burley) {
        std::vector<MetPath> met;
        met.reserve(batch.size());
        for (const std::uint32_t k : batch)
            met.push_back(met_by(m_ways[k], m_exits[k].hit, m_exits[k].frame()));
        HitPoints ends(m_light.m_scene, m_rays, &m_light.m_progress);
        static const std::vector<AttributeRequest> kNone;
        ends.fill(met, surface ? surface->requests : kNone, kDepth + m_points.depth);
        m_light.m_direct.lift(ends.points(), {m_key.instance});
        ends.points().view = ends.points().normal;
        SurfaceClosure closure;
        Lobe& lobe = closure.lobes.emplace_back();
        lobe.burley = burley;
        lobe.normal = ends.points().normal;
        lobe.roughness.assign(batch.size(), 0.0f);
        for (const std::uint32_t k : batch) lobe.weight.push_back(m_ways[k].next.weight);
        if (!surface) {
            light_points(batch, ends.points(), closure);
            return;
        }
        const SurfaceRun ran(surface->radiance, ends.input());
        for (std::size_t i = 0; i < batch.size(); ++i) lobe.normal[i] = bent_normal(ran, i);
        light_points(batch, ran.points(), closure);
    }

    /// The mean of what scatters there.
    static Vec3f bent_normal(const SurfaceRun& ran, std::size_t i) {
        Vec3f sum(0.0f);
        for (const SubsurfaceLobe& lobe : ran.closure().subsurface)
            sum += lobe.normal[i] * luminance(lobe.weight[i]);
        return normalize_or(sum, ran.points().normal[i]);
    }

    void light_points(const std::vector<std::uint32_t>& batch, const ShadingPoints& points,
                      const SurfaceClosure& closure) {
        LeavingRays leaving;
        ReflectionParts parts;
        const std::vector<Vec3f> light =
            m_light.m_direct.reflect(points, closure, {m_key.instance}, m_parts ? &parts : nullptr,
                                     {}, nullptr, m_follows ? &leaving : nullptr);
        for (std::size_t k = 0; k < light.size(); ++k) {
            const std::size_t i = m_ways[batch[k]].next.point;
            m_direct[i] += light[k];
            if (!m_parts) continue;
            m_parts->arriving[i] += parts.arriving[k];
            m_parts->unblocked[i] += parts.unblocked[k];
        }
        for (LobeRay& ray : leaving.rays) {
            ray.point = m_ways[batch[ray.point]].next.point;
            ray.share /= static_cast<float>(m_count);
            m_leaving.push_back(ray);
        }
    }

    const SubsurfaceLight& m_light;
    const RayScene& m_rays;
    const ShadingPoints& m_points;
    const GridKey& m_key;
    const PointPaths& m_paths;
    ReflectionParts* m_parts;
    bool m_follows;  ///< what other surfaces send
    std::uint64_t m_seed;
    int m_count = 1;  ///< of ways a point
    // Of the point at hand, at the time of the body.
    Vec3f m_p{0.0f}, m_normal{0.0f};
    float m_rounding = 0.0f;  ///< of it, metres
    bool m_front = false;     ///< some point of a lattice is seen from the front
    std::vector<Vec3f> m_direct;
    WaysGone m_gone;
    RayScene::Body m_body;
    std::vector<RayScene::Met> m_exits;
    std::vector<Probed> m_probed;
    std::vector<BouncedPath> m_ways;  ///< [exits]
    std::vector<LobeRay> m_leaving;
};

SubsurfaceLight::SubsurfaceLight(const Scene& scene, const DirectLight& direct, BentSurface bent,
                                 const Progress& progress)
    : m_scene(scene),
      m_direct(direct),
      m_bent(std::move(bent)),
      m_progress(progress),
      m_shutter(scene.options.shutter_curve) {}

ScatteredLight SubsurfaceLight::gather(const ShadingPoints& points, const SurfaceClosure& closure,
                                       const GridKey& key, const PointPaths& paths,
                                       ReflectionParts* parts, const BouncedLight* bounces) const {
    Batch batch(*this, points, key, paths, parts, bounces != nullptr);
    batch.scatter(closure.subsurface);
    const auto told = [&](const std::vector<Vec3f>& light) {
        return tell_scattered(points, closure, batch.gone(), light);
    };
    if (!bounces) return {told(batch.direct()), {}};
    const GatheredLight gathered = bounces->gather(batch.leaving(), points.count);
    for (std::size_t i = 0; i < gathered.world.size(); ++i)
        batch.direct()[i] += total(gathered.world[i]);
    return {told(batch.direct()), told(gathered.diffuse)};
}

void SubsurfaceLight::scatter(const ShadingPoints& hits, const SurfaceClosure& closure,
                              const GridKey& key, std::vector<Vec3f>& radiance,
                              std::vector<LobeRay>& leaving) const {
    const PointPaths none;  // they are where they were met
    Batch batch(*this, hits, key, none, nullptr, true);
    batch.scatter(closure.subsurface);
    for (std::size_t i = 0; i < hits.count; ++i) radiance[i] += batch.direct()[i];
    leaving.insert(leaving.end(), batch.leaving().begin(), batch.leaving().end());
}

}  // namespace granita
