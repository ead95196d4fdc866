// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/world_light.h"

#include <algorithm>
#include <cmath>

#include "shade/lights/power_heuristic.h"

namespace granita {
namespace {

/// How likely lobes' samples of what diffuse lobes reflect are taken to be where these are shared
/// with the world's own: the same at all points that share light, whatever else they reflect.
float shared_density(const LitPoint& point, const Vec3f& wo) {
    return std::abs(glm::dot(point.at_frame.normal, wo)) / kPi;
}

}  // namespace

WorldLight::WorldLight(const World& world, WorldEvaluator evaluator, Report& report,
                       const Progress& progress)
    : m_evaluator(std::move(evaluator)), m_most_bounces(world.most_bounces) {
    if (!world.lights_scene || !m_evaluator.radiance) return;
    m_environment = std::make_unique<Environment>(m_evaluator, progress);
    if (m_environment->broken() > 0 && !m_evaluator.is_constant)
        report.warn("world '" + world.name + "'",
                    "is not finite in some directions, which are black", m_environment->broken());
    if (m_environment->is_black()) m_environment.reset();
}

void WorldLight::sample(const LampSet& set, LitGrid& grid, const LitPoint& point) const {
    // A constant world needs no table: the lobes themselves are its best samples.
    if (!has_density() || !is_asked(grid.depth)) return;
    const SobolPoints sequence = grid.sequence(point, 0, point.sample_count);
    for (int s = 0; s < point.sample_count; ++s) {
        const auto index = static_cast<std::uint32_t>(s);
        const Environment::Sample from = m_environment->sample(sequence(index));
        const Vec3f& wo = from.direction;
        const BsdfValue value = point.bsdf.evaluate(wo);
        if (total(value) == Vec3f(0.0f) || !(from.pdf > 0.0f)) continue;
        const auto count = static_cast<float>(point.sample_count);
        const float density = power_density(count * from.pdf, grid.lobe_density(point, wo));
        const Vec3f seen = set.occlusion(grid, point, set.place_at(point, sequence.third(index)),
                                         wo, RayType::Shadow);
        BsdfValue weight = value * (seen / density);
        if (grid.takes_world())
            weight.diffuse =
                value.diffuse * seen / (count * power_density(from.pdf, shared_density(point, wo)));
        const float sign = LitGrid::sign(s, point.sample_count);
        if (m_environment->has_radiance())
            grid.reflect_world(
                point.index, of_texel(from, weight, grid.blurred_rays(point.is_through(wo))), sign);
        else
            grid.look(grid.by_lobe && point.is_through(wo) ? grid.through : grid.blurred,
                      point.index, wo, weight, sign);
    }
}

void WorldLight::meet(const LampSet& set, LitGrid& grid, const LitPoint& point,
                      const LitPlace& place, const LobeSample& sample) const {
    const Vec3f& wo = sample.wo;
    const PartRays& types = grid.blurred_rays(point.is_through(wo));
    BsdfValue weight = sample.value;
    if (!grid.samples_diffuse()) weight.diffuse = Vec3f(0.0f);
    if (total(weight) == Vec3f(0.0f)) return;
    const Environment::Sample at = m_environment->at(wo);
    const float share = share_of_lobes(set, grid, point, wo, at.pdf) / grid.lobe_density(point, wo);
    weight = weight * (set.occlusion(grid, point, place, wo, sample.type) * share);
    if (m_environment->is_constant()) {
        grid.reflect_world(point.index, of_constant(weight, types), sample.sign);
    } else if (m_environment->has_radiance() && !sample.is_narrow) {
        grid.reflect_world(point.index, of_texel(at, weight, types), sample.sign);
    } else {
        grid.look(grid.by_lobe && point.is_through(wo) ? grid.through : grid.met, point.index, wo,
                  weight, sample.sign);
    }
}

float WorldLight::share_of_lobes(const LampSet& set, const LitGrid& grid, const LitPoint& point,
                                 const Vec3f& wo, float pdf) const {
    if (!is_asked(grid.depth)) return point.left_to_lobes(wo, pdf / (set.places + 1.0f));
    return power_share(grid.lobe_density(point, wo), static_cast<float>(point.sample_count) * pdf);
}

WorldAhead WorldLight::ahead(const LampSet& set, const LitGrid& grid, const LitPoint& point,
                             const LobeSample& sample) const {
    if (!shines()) return {};
    const PartRays& types = grid.blurred_rays(point.is_through(sample.wo));
    const Environment::Sample at = m_environment->at(sample.wo);
    const float of_lobes = share_of_lobes(set, grid, point, sample.wo, at.pdf);
    float of_diffuse = of_lobes;
    if (grid.shares_world() && at.pdf > 0.0f)
        of_diffuse = power_share(shared_density(point, sample.wo), at.pdf);
    const BsdfValue weight{Vec3f(of_diffuse), Vec3f(of_lobes), Vec3f(of_lobes)};
    if (m_environment->is_constant()) return {of_constant(weight, types), 0.0f, 0.0f, sample.sign};
    if (!m_environment->has_radiance() || sample.is_narrow)
        return {{}, of_diffuse, of_lobes, sample.sign};
    return {of_texel(at, weight, types), 0.0f, 0.0f, sample.sign};
}

WorldAhead WorldLight::ahead_of_mirror() const {
    if (!shines()) return {};
    return {.asked_by_diffuse = 1.0f, .asked_by_others = 1.0f};
}

void WorldLight::radiance(const std::vector<Vec3f>& directions, const PartRays& types,
                          std::vector<BsdfValue>& out) const {
    const float spread = is_sharp(types.glossy) ? 0.0f : m_environment->texel_angle();
    std::vector<Vec3f> seen;
    out.resize(directions.size());
    for (const LightPart part : {LightPart::Glossy, LightPart::Transmission, LightPart::Diffuse}) {
        if (seen.empty() || by_lobe())
            m_evaluator.radiance(directions, spread, types.of(part), seen);
        for (std::size_t k = 0; k < seen.size(); ++k) out[k].part(part) = seen[k];
    }
}

BsdfValue WorldLight::of_constant(const BsdfValue& weight, const PartRays& types) const {
    return {weight.diffuse * m_environment->constant_radiance(types.diffuse),
            weight.glossy * m_environment->constant_radiance(types.glossy),
            weight.transmission * m_environment->constant_radiance(types.transmission)};
}

/// What a texel of the world's table sends, reflected by `weight`.
BsdfValue WorldLight::of_texel(const Environment::Sample& from, const BsdfValue& weight,
                               const PartRays& types) const {
    return {weight.diffuse * m_environment->texel_radiance(from.texel, types.diffuse),
            weight.glossy * m_environment->texel_radiance(from.texel, types.glossy),
            weight.transmission * m_environment->texel_radiance(from.texel, types.transmission)};
}

void WorldLight::deliver(LitGrid& grid) const {
    if (!shines()) return;
    look(grid, grid.blurred, m_environment->texel_angle(), grid.blurred_rays(false));
    look(grid, grid.met, m_environment->texel_angle(), grid.blurred_rays(false));
    look(grid, grid.through, m_environment->texel_angle(), grid.blurred_rays(true));
    // A point of its own stands for no neighbours: the mean of many does.
    look(grid, grid.sharp, grid.placed ? 0.0f : grid.sharp.spread(), kSharp);
}

void WorldLight::look(LitGrid& grid, const EnvironmentSamples& samples, float spread,
                      const PartRays& types) const {
    if (samples.directions.empty()) return;
    std::vector<Vec3f> seen;
    if (!by_lobe()) {
        m_evaluator.radiance(samples.directions, spread, types.glossy, seen);
        for (std::size_t k = 0; k < seen.size(); ++k) {
            if (!is_finite(seen[k])) continue;
            grid.add(samples.points[k], samples.weights[k] * seen[k], samples.signs[k]);
            if (grid.parts) grid.add_world(samples.points[k], samples.parts[k] * seen[k]);
        }
        return;
    }
    std::vector<BsdfValue> values = samples.parts;
    const auto look_by = [&](LightPart part, RayType type) {
        const bool any = std::ranges::any_of(
            values, [&](BsdfValue& value) { return value.part(part) != Vec3f(0.0f); });
        if (!any) return;
        m_evaluator.radiance(samples.directions, spread, type, seen);
        for (std::size_t k = 0; k < seen.size(); ++k) values[k].part(part) *= seen[k];
    };
    look_by(LightPart::Diffuse, types.diffuse);
    look_by(LightPart::Glossy, types.glossy);
    look_by(LightPart::Transmission, types.transmission);
    for (std::size_t k = 0; k < values.size(); ++k)
        if (is_finite(total(values[k])))
            grid.reflect_world(samples.points[k], values[k], samples.signs[k]);
}

}  // namespace granita
