// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/direct_light.h"

#include <cmath>
#include <limits>

#include "shade/bsdf.h"
#include "shade/bsdf_albedo.h"
#include "shade/light_source.h"
#include "shade/ray_scene.h"
#include "shade/sampling.h"
#include "shade/shading_points.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A lamp with what it may do to whom.
struct Lamp {
    std::unique_ptr<LightSource> source;
    bool casts_shadow = true;
    float diffuse = 1.0f, glossy = 1.0f;

    Vec3f apply(const BsdfValue& value) const {
        return value.diffuse * diffuse + value.glossy * glossy;
    }
};

/// Looks into the world that wait for their radiance: the world is asked once for many directions.
struct WorldLooks {
    std::vector<Vec3f> directions;
    std::vector<Vec3f> weights;
    std::vector<std::size_t> points;

    void add(std::size_t point, const Vec3f& direction, const Vec3f& weight) {
        directions.push_back(direction);
        weights.push_back(weight);
        points.push_back(point);
    }
    /// Mean angle between the directions of neighbouring points: what one of them stands for.
    float spread() const {
        float sum = 0.0f;
        int pairs = 0;
        for (std::size_t k = 1; k < points.size(); ++k) {
            if (points[k] != points[k - 1] + 1) continue;
            // A row's end and the next row's start are neighbours in the list alone.
            const float angle = glm::length(directions[k] - directions[k - 1]);
            if (angle > kWidestSpread) continue;
            sum += angle;
            ++pairs;
        }
        return pairs > 0 ? sum / static_cast<float>(pairs) : 0.0f;
    }
    static constexpr float kWidestSpread = 0.5f;
};

/// What a grid's points share while they are lit.
struct Work {
    std::uint64_t seed;
    std::vector<Vec3f>& radiance;
    WorldLooks blurred, sharp;
    std::uint64_t shadow_rays = 0, occlusion_rays = 0;
};

/// A shaded point while it is lit.
struct Point {
    std::size_t index;
    const PointBsdf& bsdf;
    Vec3f p, start;
    std::uint64_t seed;
    std::vector<int> samples;  ///< [lobes] taken of each lobe; 0 for sharp ones

    SobolPoints sequence(std::uint64_t dimension) const {
        return SobolPoints(seed + 0x9e3779b97f4a7c15ULL * (dimension + 1));
    }
    /// Expected samples a solid angle around `wo` over the lobes that `which` accepts.
    template <class Which>
    float lobe_density(const Vec3f& wo, Which which) const {
        float sum = 0.0f;
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (samples[k] > 0 && which(k)) sum += static_cast<float>(samples[k]) * bsdf.pdf(k, wo);
        return sum;
    }
    /// Lamps are met by samples of glossy lobes alone: over a diffuse lobe, sampling the lamp is
    /// never much worse.
    float glossy_density(const Vec3f& wo) const {
        return lobe_density(wo, [&](std::size_t k) { return bsdf.kind(k) == LobeKind::Glossy; });
    }
    float all_density(const Vec3f& wo) const {
        return lobe_density(wo, [](std::size_t) { return true; });
    }
};

}  // namespace

struct DirectLight::Impl {
    Impl(const Scene& scene, WorldEvaluator world_evaluator, Statistics& frame_statistics,
         Report& report, const Progress& progress, ShadowOpacity opacity);

    void light_point(Work& work, Point& point) const;
    void sample_lamp(Work& work, const Point& point, const Lamp& lamp, std::uint64_t dimension,
                     Vec3f& sum) const;
    void sample_world(Work& work, const Point& point) const;
    void sample_lobe(Work& work, const Point& point, std::size_t lobe, Vec3f& sum) const;
    void mirror(Work& work, const Point& point, std::size_t lobe, Vec3f& sum) const;
    void look(const WorldLooks& looks, float spread, std::vector<Vec3f>& radiance) const;
    Vec3f shadow(Work& work, const Point& point, const Lamp& lamp, const Vec3f& direction,
                 float distance) const;
    Vec3f occlusion(Work& work, const Point& point, const Vec3f& direction) const;

    const Scene& scene;
    WorldEvaluator world;
    Statistics& statistics;
    const Progress& progress;
    int sample_count;
    std::vector<Lamp> lamps;
    std::unique_ptr<Environment> environment;  ///< nullptr where the world sheds no light
    std::unique_ptr<RayScene> rays;            ///< nullptr where nothing can cast a shadow
};

DirectLight::Impl::Impl(const Scene& frame_scene, WorldEvaluator world_evaluator,
                        Statistics& frame_statistics, Report& report,
                        const Progress& frame_progress, ShadowOpacity opacity)
    : scene(frame_scene),
      world(std::move(world_evaluator)),
      statistics(frame_statistics),
      progress(frame_progress),
      sample_count(std::max(1, frame_scene.options.light_samples)) {
    const float time = scene.options.frame_time;
    const Vec3d origin(matrix_at(scene.camera.world_from_camera, time)[3]);
    for (const Light& light : scene.lights) {
        if (light.color * light.energy == Vec3f(0.0f)) continue;
        Lamp lamp;
        lamp.source = make_light_source(light, time, origin);
        lamp.casts_shadow = light.casts_shadow;
        lamp.diffuse = light.visible_diffuse ? light.diffuse_factor : 0.0f;
        lamp.glossy = light.visible_glossy ? light.specular_factor : 0.0f;
        lamps.push_back(std::move(lamp));
    }
    if (scene.world.lights_scene && world) {
        environment = std::make_unique<Environment>(world, progress);
        if (environment->broken() > 0)
            report.warn("world '" + scene.world.name + "'",
                        "is not finite in some directions, which light as black",
                        environment->broken());
        if (environment->is_black()) environment.reset();
    }
    if (lamps.empty() && !environment) return;
    StageTimer timer(statistics, Stage::RayBuild);
    rays = std::make_unique<RayScene>(scene, origin, std::move(opacity), progress);
    statistics.peak_ray_bytes(rays->bytes());
    if (rays->empty()) rays.reset();
}

Vec3f DirectLight::Impl::shadow(Work& work, const Point& point, const Lamp& lamp,
                                const Vec3f& direction, float distance) const {
    if (!rays || !lamp.casts_shadow) return Vec3f(1.0f);
    ++work.shadow_rays;
    return rays->transmittance(point.start, direction, distance);
}

Vec3f DirectLight::Impl::occlusion(Work& work, const Point& point, const Vec3f& direction) const {
    if (!rays) return Vec3f(1.0f);
    ++work.occlusion_rays;
    return rays->transmittance(point.start, direction, kInfinity);
}

void DirectLight::Impl::sample_lamp(Work& work, const Point& point, const Lamp& lamp,
                                    std::uint64_t dimension, Vec3f& sum) const {
    const bool hard = lamp.source->is_hard();
    const int count = hard ? 1 : sample_count;
    const SobolPoints sequence = point.sequence(dimension);
    for (int s = 0; s < count; ++s) {
        LightSample sample;
        if (!lamp.source->sample(point.p, sequence(static_cast<std::uint32_t>(s)), sample))
            continue;
        Vec3f value = lamp.apply(point.bsdf.evaluate(sample.direction)) * sample.radiance;
        if (value == Vec3f(0.0f)) continue;
        if (!hard)
            value /= static_cast<float>(count) * sample.pdf +
                     (lamp.glossy > 0.0f ? point.glossy_density(sample.direction) : 0.0f);
        sum += value * shadow(work, point, lamp, sample.direction, sample.distance);
    }
}

void DirectLight::Impl::sample_world(Work& work, const Point& point) const {
    // A constant world needs no table: the lobes themselves are its best samples.
    if (!environment || environment->is_constant()) return;
    const SobolPoints sequence = point.sequence(0);
    for (int s = 0; s < sample_count; ++s) {
        float pdf = 0.0f;
        const Vec3f wo = environment->sample(sequence(static_cast<std::uint32_t>(s)), pdf);
        const BsdfValue value = point.bsdf.evaluate(wo);
        Vec3f weight = value.diffuse + value.glossy;
        if (weight == Vec3f(0.0f) || !(pdf > 0.0f)) continue;
        weight /= static_cast<float>(sample_count) * pdf + point.all_density(wo);
        weight *= occlusion(work, point, wo);
        if (weight != Vec3f(0.0f)) work.blurred.add(point.index, wo, weight);
    }
}

void DirectLight::Impl::sample_lobe(Work& work, const Point& point, std::size_t lobe,
                                    Vec3f& sum) const {
    const bool glossy = point.bsdf.kind(lobe) == LobeKind::Glossy;
    if (!environment && !glossy) return;
    const SobolPoints sequence = point.sequence(1 + lobe);
    for (int s = 0; s < point.samples[lobe]; ++s) {
        Vec3f wo;
        if (!point.bsdf.sample(lobe, sequence(static_cast<std::uint32_t>(s)), wo)) continue;
        const BsdfValue value = point.bsdf.evaluate(wo);
        const Vec3f both = value.diffuse + value.glossy;
        if (both == Vec3f(0.0f)) continue;
        if (environment) {
            float density = point.all_density(wo);
            if (!environment->is_constant())
                density += static_cast<float>(sample_count) * environment->pdf(wo);
            const Vec3f weight = both / density * occlusion(work, point, wo);
            if (environment->is_constant())
                sum += weight * environment->constant_radiance();
            else if (weight != Vec3f(0.0f))
                work.blurred.add(point.index, wo, weight);
        }
        if (!glossy) continue;
        for (const Lamp& lamp : lamps) {
            LightSample sample;
            if (lamp.glossy <= 0.0f || !lamp.source->intersect(point.p, wo, sample)) continue;
            const float density =
                static_cast<float>(sample_count) * sample.pdf + point.glossy_density(wo);
            sum += lamp.apply(value) * sample.radiance / density *
                   shadow(work, point, lamp, wo, sample.distance);
        }
    }
}

void DirectLight::Impl::mirror(Work& work, const Point& point, std::size_t lobe, Vec3f& sum) const {
    Vec3f wo, reflectance;
    if (!point.bsdf.reflect(lobe, wo, reflectance)) return;
    for (const Lamp& lamp : lamps) {
        LightSample sample;
        if (lamp.glossy <= 0.0f || !lamp.source->intersect(point.p, wo, sample)) continue;
        sum += reflectance * lamp.glossy * sample.radiance *
               shadow(work, point, lamp, wo, sample.distance);
    }
    if (!environment) return;
    const Vec3f weight = reflectance * occlusion(work, point, wo);
    if (weight != Vec3f(0.0f)) work.sharp.add(point.index, wo, weight);
}

void DirectLight::Impl::light_point(Work& work, Point& point) const {
    Vec3f sum(0.0f);
    const std::size_t lobes = point.bsdf.lobe_count();
    point.samples.assign(lobes, 0);
    for (std::size_t k = 0; k < lobes; ++k)
        if (!point.bsdf.is_sharp(k))
            point.samples[k] =
                std::max(1, static_cast<int>(std::lround(point.bsdf.importance(k) *
                                                         static_cast<float>(sample_count))));
    for (std::size_t l = 0; l < lamps.size(); ++l)
        sample_lamp(work, point, lamps[l], 1 + lobes + l, sum);
    sample_world(work, point);
    for (std::size_t k = 0; k < lobes; ++k) {
        if (point.bsdf.is_sharp(k))
            mirror(work, point, k, sum);
        else
            sample_lobe(work, point, k, sum);
    }
    work.radiance[point.index] += sum;
}

void DirectLight::Impl::look(const WorldLooks& looks, float spread,
                             std::vector<Vec3f>& radiance) const {
    if (looks.directions.empty()) return;
    std::vector<Vec3f> seen;
    world(looks.directions, spread, seen);
    for (std::size_t k = 0; k < seen.size(); ++k)
        if (is_finite(seen[k])) radiance[looks.points[k]] += looks.weights[k] * seen[k];
}

DirectLight::DirectLight(const Scene& scene, WorldEvaluator world, Statistics& statistics,
                         Report& report, const Progress& progress, ShadowOpacity opacity)
    : m_impl(std::make_unique<Impl>(scene, std::move(world), statistics, report, progress,
                                    std::move(opacity))) {}

DirectLight::~DirectLight() = default;

std::vector<Vec3f> DirectLight::reflect(const ShadingPoints& points, const SurfaceClosure& closure,
                                        const GridKey& key) const {
    std::vector<Vec3f> radiance(points.count, Vec3f(0.0f));
    if (closure.lobes.empty() || (m_impl->lamps.empty() && !m_impl->environment)) return radiance;
    const GgxAlbedo& albedo = GgxAlbedo::shared();
    Work work{grid_seed(key, m_impl->scene.options.seed), radiance, {}, {}};
    for (std::size_t i = 0; i < points.count; ++i) {
        m_impl->progress.check();
        const PointBsdf bsdf(closure, points, i, albedo);
        if (bsdf.lobe_count() == 0) continue;
        Point point{i, bsdf, points.p[i], points.p[i], mix_bits(work.seed + i), {}};
        if (m_impl->rays)
            point.start = m_impl->rays->lift(key, point.p, points.geometric_normal[i]);
        m_impl->light_point(work, point);
    }
    if (m_impl->environment)
        m_impl->look(work.blurred, m_impl->environment->texel_angle(), radiance);
    m_impl->look(work.sharp, work.sharp.spread(), radiance);
    m_impl->statistics.add(Counter::RaysShadow, work.shadow_rays);
    m_impl->statistics.add(Counter::RaysOcclusion, work.occlusion_rays);
    return radiance;
}

}  // namespace granita
