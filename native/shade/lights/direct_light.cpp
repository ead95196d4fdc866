// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/direct_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "base/stage_timer.h"
#include "scene/knot_time.h"
#include "scene/shutter_warp.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/lights/light_lamp.h"
#include "shade/lights/lit_grid.h"
#include "shade/lights/lit_point.h"
#include "shade/lights/lobe_runs.h"
#include "shade/lights/shadow_queue.h"
#include "shade/rays/ray_scene.h"

namespace granita {
namespace {

/// Seed of a grid, from its identity alone (decision 3).
std::uint64_t grid_seed(const GridKey& key, std::uint32_t frame_seed) {
    const auto face = (static_cast<std::uint64_t>(key.instance) << 32) | key.face;
    return mix_bits(mix_bits(face + 0x9e3779b97f4a7c15ULL * (frame_seed + 1ULL)) ^ key.path);
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

struct DirectLight::Impl {
    Impl(const Scene& scene, WorldEvaluator world_evaluator, Statistics& frame_statistics,
         Report& report, const Progress& progress, ShadowOpacity opacity,
         std::shared_ptr<GeometryCache> cache);

    void light_points(LitGrid& grid, const std::vector<LitPoint>& points,
                      std::size_t lobe_count) const;
    void sample_lamp(LitGrid& grid, const LitPoint& point, const Lamp& lamp, std::size_t dimension,
                     ShadowQueue& shadows) const;
    void sample_world(LitGrid& grid, const LitPoint& point) const;
    void add_texel(LitGrid& grid, const LitPoint& point, const Environment::Sample& from,
                   const BsdfValue& weight, float sign) const;
    void sample_lobe(LitGrid& grid, const LitPoint& point, std::size_t lobe) const;
    void mirror(LitGrid& grid, const LitPoint& point, std::size_t lobe) const;
    void look(LitGrid& grid, const EnvironmentSamples& samples, float spread, RayType glossy) const;
    LitPlace place_at(const LitPoint& point, float uniform) const;
    bool changes(const Lamp& lamp) const;
    std::uint64_t receives(const GridKey& key) const;
    int samples_of(const LitPoint& point, const Lamp& lamp) const;
    ShadowRay ray(const LitPoint& point, const LitPlace& place, const Vec3f& direction,
                  float distance, int blocker_set = -1) const;
    Vec3f shadow(LitGrid& grid, const LitPoint& point, const LitPlace& place, const Lamp& lamp,
                 const LightSample& sample) const;
    Vec3f occlusion(LitGrid& grid, const LitPoint& point, const LitPlace& place,
                    const Vec3f& direction) const;

    const Scene& scene;
    WorldEvaluator world;
    Statistics& statistics;
    const Progress& progress;
    std::shared_ptr<GeometryCache> geometries;
    int sample_count;
    ShutterWarp shutter;
    std::vector<Lamp> lamps;
    std::unique_ptr<Environment> environment;  ///< nullptr where the world sheds no light
    std::unique_ptr<RayScene> rays;            ///< nullptr where nothing can cast a shadow
    std::unordered_map<std::uint32_t, std::uint64_t> linked;  ///< Instance::receives by key
    bool casters_move = false;
    bool varies = false;  ///< casters or lamps do
};

DirectLight::Impl::Impl(const Scene& frame_scene, WorldEvaluator world_evaluator,
                        Statistics& frame_statistics, Report& report,
                        const Progress& frame_progress, ShadowOpacity opacity,
                        std::shared_ptr<GeometryCache> cache)
    : scene(frame_scene),
      world(std::move(world_evaluator)),
      statistics(frame_statistics),
      progress(frame_progress),
      geometries(cache ? std::move(cache) : std::make_shared<GeometryCache>()),
      sample_count(std::max(1, frame_scene.options.light_samples)),
      shutter(frame_scene.options.shutter_curve) {
    const float time = scene.options.frame_time;
    const Vec3d origin(matrix_at(scene.camera.world_from_camera, time)[3]);
    for (const Light& light : scene.lights) {
        float energy = std::abs(light.energy);
        for (const float knot : light.energy_knots) energy = std::max(energy, std::abs(knot));
        if (light.color * energy == Vec3f(0.0f) || light.lifespan.is_empty()) continue;
        lamps.emplace_back(light, time, origin);
        varies = varies || lamps.back().varies();
    }
    for (const Instance& instance : scene.instances)
        if (instance.receives != ~0ULL) linked[instance.key] = instance.receives;
    if (scene.world.lights_scene && world.radiance) {
        environment = std::make_unique<Environment>(world, progress);
        if (environment->broken() > 0)
            report.warn("world '" + scene.world.name + "'",
                        "is not finite in some directions, which light as black",
                        environment->broken());
        if (environment->is_black()) environment.reset();
    }
    const bool shadows = environment || std::ranges::any_of(lamps, [](const Lamp& lamp) {
                             return lamp.casts_shadow();
                         });
    if (!shadows) return;
    StageTimer timer(statistics, Stage::RayBuild);
    rays = std::make_unique<RayScene>(scene, origin, std::move(opacity), progress, geometries,
                                      &report);
    statistics.peak_ray_bytes(rays->bytes());
    if (rays->empty()) rays.reset();
    casters_move = rays && rays->moves();
    varies = varies || casters_move;
}

/// The point at a time of its life drawn by `uniform` in [0, 1) through the shutter; at the frame
/// time where nothing that light depends on changes.
LitPlace DirectLight::Impl::place_at(const LitPoint& point, float uniform) const {
    LitPlace place = point.at_frame;
    if (!varies) return place;
    place.time = shutter.time(point.exposed.x + uniform * (point.exposed.y - point.exposed.x));
    if (!point.paths.moves()) return place;
    const PointPaths::Place on_path = point.paths.at(point.index, place.time);
    place.p = on_path.p;
    place.normal = on_path.normal;
    place.start = point.ray_offset(on_path.start, on_path.normal);
    return place;
}

std::uint64_t DirectLight::Impl::receives(const GridKey& key) const {
    const auto found = linked.find(key.instance);
    return found == linked.end() ? ~0ULL : found->second;
}

bool DirectLight::Impl::changes(const Lamp& lamp) const {
    return lamp.varies() || (casters_move && lamp.casts_shadow());
}

/// None of a lamp below the horizon; one tells all about a lamp without size that nothing moving
/// can come before.
int DirectLight::Impl::samples_of(const LitPoint& point, const Lamp& lamp) const {
    Vec3f center;
    float radius;
    const bool still = !lamp.varies() && !point.paths.moves();
    if (still && lamp.at(0.0f).bound(center, radius) &&
        !point.bsdf.can_see(center - point.at_frame.p, radius))
        return 0;
    if (!lamp.is_hard()) return point.sample_count;
    if (!changes(lamp)) return 1;
    if (lamp.varies() || point.paths.moves()) return point.sample_count;
    const LitPlace& place = point.at_frame;
    LightSample sample;
    if (!lamp.at(place.time).sample(place.p, Vec2f(0.0f), sample)) return 0;
    return rays->varies(place.start, sample.direction, sample.distance) ? point.sample_count : 1;
}

ShadowRay DirectLight::Impl::ray(const LitPoint& point, const LitPlace& place,
                                 const Vec3f& direction, float distance, int blocker_set) const {
    const bool turned_away = glm::dot(place.normal, direction) <= 0.0f &&
                             glm::dot(point.at_frame.normal, direction) > 0.0f;
    const LitPlace& from = turned_away ? point.at_frame : place;
    return {from.start, direction, distance, from.time, blocker_set};
}

Vec3f DirectLight::Impl::shadow(LitGrid& grid, const LitPoint& point, const LitPlace& place,
                                const Lamp& lamp, const LightSample& sample) const {
    if (!rays || !lamp.casts_shadow()) return Vec3f(1.0f);
    ++grid.shadow_rays;
    return rays->transmittance(
        ray(point, place, sample.direction, sample.distance, lamp.blocker_set()));
}

Vec3f DirectLight::Impl::occlusion(LitGrid& grid, const LitPoint& point, const LitPlace& place,
                                   const Vec3f& direction) const {
    if (!rays) return Vec3f(1.0f);
    ++grid.occlusion_rays;
    return rays->transmittance(ray(point, place, direction, kInfinity));
}

void DirectLight::Impl::sample_lamp(LitGrid& grid, const LitPoint& point, const Lamp& lamp,
                                    std::size_t dimension, ShadowQueue& shadows) const {
    const int count = samples_of(point, lamp);
    // One sample of many tells all where nothing varies along its ray; one of one is any time's.
    const bool timed = changes(lamp) && (count > 1 || point.sample_count == 1);
    const SobolPoints sequence = grid.sequence(point, dimension, count);
    const auto add = [&](const LitPlace& place, const LightSource& source,
                         const LightSample& sample, int s) {
        if (!(sample.pdf > 0.0f)) return;
        const BsdfValue bsdf = lamp.apply(point.bsdf.evaluate(sample.direction));
        const Vec3f value = total(bsdf) * sample.radiance;
        if (value == Vec3f(0.0f)) return;
        float density = static_cast<float>(count) * sample.pdf;
        if (!source.is_hard() && lamp.reaches_glossy())
            density += point.glossy_density(sample.direction);
        const BsdfValue parts = bsdf * (sample.radiance / density);
        if (rays && lamp.casts_shadow())
            shadows.send(point.index, value / density, parts, LitGrid::sign(s, count),
                         ray(point, place, sample.direction, sample.distance, lamp.blocker_set()));
        else
            shadows.send(point.index, value / density, parts, LitGrid::sign(s, count));
    };
    grid.lamp_points.clear();
    for (int s = 0; s < count; ++s)
        grid.lamp_points.push_back(sequence(static_cast<std::uint32_t>(s)));
    grid.lamp_samples.resize(grid.lamp_points.size());
    if (!timed) {
        const LitPlace& place = point.at_frame;
        if (!lamp.exists(place.time)) return;
        const LightSource& source = lamp.at(place.time);
        source.sample_all(place.p, grid.lamp_points, grid.lamp_samples);
        for (int s = 0; s < count; ++s)
            add(place, source, grid.lamp_samples[static_cast<std::size_t>(s)], s);
        return;
    }
    for (std::size_t s = 0; s < grid.lamp_points.size(); ++s) {
        const LitPlace place = place_at(point, sequence.third(static_cast<std::uint32_t>(s)));
        if (!lamp.exists(place.time)) continue;
        const LightSource& source = lamp.at(place.time);
        source.sample(place.p, grid.lamp_points[s], grid.lamp_samples[s]);
        add(place, source, grid.lamp_samples[s], static_cast<int>(s));
    }
}

void DirectLight::Impl::sample_world(LitGrid& grid, const LitPoint& point) const {
    // A constant world needs no table: the lobes themselves are its best samples.
    if (!environment || !environment->has_density()) return;
    const SobolPoints sequence = grid.sequence(point, 0, point.sample_count);
    for (int s = 0; s < point.sample_count; ++s) {
        const auto index = static_cast<std::uint32_t>(s);
        const Environment::Sample from = environment->sample(sequence(index));
        const Vec3f& wo = from.direction;
        const BsdfValue value = point.bsdf.evaluate(wo);
        if (total(value) == Vec3f(0.0f) || !(from.pdf > 0.0f)) continue;
        const float density =
            static_cast<float>(point.sample_count) * from.pdf + point.all_density(wo);
        const Vec3f seen = occlusion(grid, point, place_at(point, sequence.third(index)), wo);
        const BsdfValue weight = value * (seen / density);
        const float sign = LitGrid::sign(s, point.sample_count);
        if (environment->has_radiance())
            add_texel(grid, point, from, weight, sign);
        else
            grid.look(grid.blurred, point.index, wo, weight, sign);
    }
}

/// What a texel of the world's table sends, reflected by `weight`.
void DirectLight::Impl::add_texel(LitGrid& grid, const LitPoint& point,
                                  const Environment::Sample& from, const BsdfValue& weight,
                                  float sign) const {
    const BsdfValue reflected{
        weight.diffuse * environment->texel_radiance(from.texel, RayType::Diffuse),
        weight.glossy * environment->texel_radiance(from.texel, RayType::Glossy)};
    grid.add(point.index, total(reflected), sign);
    grid.add_world(point.index, reflected);
}

void DirectLight::Impl::sample_lobe(LitGrid& grid, const LitPoint& point, std::size_t lobe) const {
    const bool glossy = point.bsdf.kind(lobe) == LobeKind::Glossy;
    if (!environment && !glossy) return;
    const LitPoint::LobeSamples& samples = point.samples[lobe];
    const SobolPoints sequence = grid.sequence(1 + point.bsdf.index(lobe), samples.first);
    for (int s = 0; s < samples.count; ++s) {
        const auto index = static_cast<std::uint32_t>(s);
        Vec3f wo;
        if (!point.bsdf.sample(lobe, sequence(index), wo)) continue;
        const BsdfValue value = point.bsdf.evaluate(wo);
        if (total(value) == Vec3f(0.0f)) continue;
        const LitPlace place = place_at(point, sequence.third(index));
        const float sign = LitGrid::sign(s, samples.count);
        if (environment) {
            const Environment::Sample at = environment->at(wo);
            const float density =
                point.all_density(wo) + static_cast<float>(point.sample_count) * at.pdf;
            const BsdfValue weight = value * (occlusion(grid, point, place, wo) / density);
            if (environment->is_constant()) {
                const BsdfValue reflected{
                    weight.diffuse * environment->constant_radiance(RayType::Diffuse),
                    weight.glossy * environment->constant_radiance(RayType::Glossy)};
                grid.add(point.index, total(reflected), sign);
                grid.add_world(point.index, reflected);
            } else if (environment->has_radiance() && !glossy) {
                add_texel(grid, point, at, weight, sign);
            } else {
                // Some lobes are narrower than the table's texels.
                grid.look(grid.blurred, point.index, wo, weight, sign);
            }
        }
        if (!glossy) continue;
        for (const Lamp& lamp : lamps) {
            LightSample sample;
            if (!lamp.lights(grid.receives) || !lamp.reaches_glossy() ||
                !lamp.meets(place.time, place.p, wo, sample))
                continue;
            const float density =
                static_cast<float>(point.sample_count) * sample.pdf + point.glossy_density(wo);
            const BsdfValue bsdf = lamp.apply(value);
            const Vec3f seen = shadow(grid, point, place, lamp, sample);
            grid.add(point.index, total(bsdf) * sample.radiance / density * seen, sign);
            grid.add_lamp(point.index, bsdf * (sample.radiance / density), seen);
        }
    }
}

void DirectLight::Impl::mirror(LitGrid& grid, const LitPoint& point, std::size_t lobe) const {
    Vec3f wo, reflectance;
    if (!point.bsdf.reflect(lobe, wo, reflectance)) return;
    const int count = varies ? point.sample_count : 1;
    reflectance /= static_cast<float>(count);
    const SobolPoints sequence = grid.sequence(point, 1 + point.bsdf.index(lobe), count);
    Vec3f open(0.0f);
    for (int s = 0; s < count; ++s) {
        const LitPlace place = place_at(point, sequence.third(static_cast<std::uint32_t>(s)));
        for (const Lamp& lamp : lamps) {
            LightSample sample;
            if (!lamp.lights(grid.receives) || !lamp.reaches_glossy() ||
                !lamp.meets(place.time, place.p, wo, sample))
                continue;
            const Vec3f value = reflectance * lamp.glossy() * sample.radiance;
            const Vec3f seen = shadow(grid, point, place, lamp, sample);
            grid.add(point.index, value * seen, LitGrid::sign(s, count));
            grid.add_lamp(point.index, {Vec3f(0.0f), value}, seen);
        }
        if (environment) open += reflectance * occlusion(grid, point, place, wo);
    }
    grid.look(grid.sharp, point.index, wo, {Vec3f(0.0f), open}, 0.0f);
}

/// Lamp by lamp, so that their rays keep together, then what only lobes find.  Dimensions are
/// numbered by the closure's lobes, which are the same for all points: 0 the world's, then the
/// lobes', then the lamps'.
void DirectLight::Impl::light_points(LitGrid& grid, const std::vector<LitPoint>& points,
                                     std::size_t lobe_count) const {
    ShadowQueue shadows(rays.get(), grid);
    for (std::size_t l = 0; l < lamps.size(); ++l) {
        if (!lamps[l].lights(grid.receives)) continue;
        for (const LitPoint& point : points) {
            progress.check();
            sample_lamp(grid, point, lamps[l], 1 + lobe_count + l, shadows);
        }
        shadows.deliver();
    }
    for (const LitPoint& point : points) {
        progress.check();
        sample_world(grid, point);
        for (std::size_t k = 0; k < point.bsdf.lobe_count(); ++k) {
            if (point.bsdf.is_sharp(k))
                mirror(grid, point, k);
            else
                sample_lobe(grid, point, k);
        }
    }
}

/// `glossy`: the type of ray that the samples' glossy parts are seen by.
void DirectLight::Impl::look(LitGrid& grid, const EnvironmentSamples& samples, float spread,
                             RayType glossy) const {
    if (samples.directions.empty()) return;
    std::vector<Vec3f> seen, seen_glossy;
    world.radiance(samples.directions, spread, world.by_lobe ? RayType::Diffuse : glossy, seen);
    if (world.by_lobe) world.radiance(samples.directions, spread, glossy, seen_glossy);
    for (std::size_t k = 0; k < seen.size(); ++k) {
        const std::size_t point = samples.points[k];
        if (world.by_lobe) {
            const BsdfValue value{samples.parts[k].diffuse * seen[k],
                                  samples.parts[k].glossy * seen_glossy[k]};
            if (!is_finite(total(value))) continue;
            grid.add(point, total(value), samples.signs[k]);
            grid.add_world(point, value);
        } else if (is_finite(seen[k])) {
            grid.add(point, samples.weights[k] * seen[k], samples.signs[k]);
            if (grid.parts) grid.add_world(point, samples.parts[k] * seen[k]);
        }
    }
}

DirectLight::DirectLight(const Scene& scene, WorldEvaluator world, Statistics& statistics,
                         Report& report, const Progress& progress, ShadowOpacity opacity,
                         std::shared_ptr<GeometryCache> geometries)
    : m_impl(std::make_unique<Impl>(scene, std::move(world), statistics, report, progress,
                                    std::move(opacity), std::move(geometries))) {}

DirectLight::~DirectLight() = default;

bool DirectLight::varies() const {
    return m_impl->varies;
}

std::vector<Vec3f> DirectLight::reflect(const ShadingPoints& points, const SurfaceClosure& closure,
                                        const GridKey& key, ReflectionParts* parts,
                                        const PointPaths& paths, std::vector<float>* noise) const {
    std::vector<Vec3f> radiance(points.count, Vec3f(0.0f));
    if (noise) noise->assign(points.count, 0.0f);
    if (parts) parts->resize(points.count);
    const bool dark = m_impl->lamps.empty() && !m_impl->environment;
    if (closure.lobes.empty() || (dark && !parts)) return radiance;
    const GgxAlbedo& albedo = GgxAlbedo::shared();
    // Points with places of their own share the sequences of the frame.
    const bool placed = !points.places.empty();
    LitGrid grid{radiance,
                 parts,
                 {},
                 {},
                 {},
                 {},
                 grid_seed(placed ? GridKey{} : key, m_impl->scene.options.seed),
                 m_impl->world.by_lobe};
    grid.placed = placed;
    grid.receives = m_impl->receives(key);
    grid.balance = noise;
    RayOffset ray_offset = m_impl->rays ? m_impl->rays->ray_offset(key) : RayOffset{};
    const Lifespan& life = paths.lifespan();
    const Vec2f life_exposed(m_impl->shutter.uniform(std::clamp(life.open, 0.0f, 1.0f)),
                             m_impl->shutter.uniform(std::clamp(life.close, 0.0f, 1.0f)));
    // Points that lie closer share the light that a pixel's worth of them is due.
    const int sample_count = std::max(
        1, static_cast<int>(std::lround(points.share * static_cast<float>(m_impl->sample_count))));
    std::vector<LitPoint> lit;
    lit.reserve(dark ? 0 : points.count);
    for (std::size_t i = 0; i < points.count; ++i) {
        PointBsdf bsdf(closure, points, i, albedo);
        if (bsdf.lobe_count() == 0) continue;
        if (parts) {
            const BsdfValue color = bsdf.albedo();
            parts->diffuse_color[i] = color.diffuse;
            parts->glossy_color[i] = color.glossy;
        }
        if (dark) continue;
        const Vec3f &p = points.p[i], &normal = points.geometric_normal[i];
        const Vec3f offset = points.ray_offset.empty() ? Vec3f(0.0f) : points.ray_offset[i];
        if (m_impl->rays && !points.faces.empty())
            ray_offset = m_impl->rays->ray_offset({key.instance, points.faces[i]});
        const Vec3f start = ray_offset(p + offset, normal);
        const bool timed = !points.times.empty() && points.times[i] >= 0.0f;
        const float time = timed ? points.times[i] : m_impl->scene.options.frame_time;
        const LitPlace at_frame{time, p, normal, start};
        const Vec2f exposed = timed ? Vec2f(m_impl->shutter.uniform(time)) : life_exposed;
        // Neighbours share a sequence: aligned squares of points, and so the pixels that average
        // them, are stratified as one (Ahmed and Wonka 2020, without their shuffling of squares).
        // Faces of a batch are in Morton order already.
        const auto place = static_cast<std::uint32_t>(
            placed                ? points.places[i]
            : points.columns == 0 ? i
                                  : morton_index(static_cast<std::uint32_t>(i % points.columns),
                                                 static_cast<std::uint32_t>(i / points.columns)));
        lit.push_back(
            {i, std::move(bsdf), paths, ray_offset, at_frame, sample_count, place, exposed, {}});
        lit.back().share_samples();
    }
    place_lobe_samples(lit, closure.lobes.size(), placed);
    m_impl->light_points(grid, lit, closure.lobes.size());
    if (m_impl->environment)
        m_impl->look(grid, grid.blurred, m_impl->environment->texel_angle(), RayType::Glossy);
    // A point of its own stands for no neighbours: the mean of many does.
    m_impl->look(grid, grid.sharp, placed ? 0.0f : grid.sharp.spread(), RayType::Singular);
    m_impl->statistics.add(Counter::RaysShadow, grid.shadow_rays);
    m_impl->statistics.add(Counter::RaysOcclusion, grid.occlusion_rays);
    return radiance;
}

}  // namespace granita
