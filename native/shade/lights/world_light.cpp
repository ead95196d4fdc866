// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/world_light.h"

#include <algorithm>

namespace granita {

WorldLight::WorldLight(const World& world, WorldEvaluator evaluator, Report& report,
                       const Progress& progress)
    : m_evaluator(std::move(evaluator)) {
    if (!world.lights_scene || !m_evaluator.radiance) return;
    m_environment = std::make_unique<Environment>(m_evaluator, progress);
    if (m_environment->broken() > 0)
        report.warn("world '" + world.name + "'",
                    "is not finite in some directions, which light as black",
                    m_environment->broken());
    if (m_environment->is_black()) m_environment.reset();
}

void WorldLight::sample(const LampSet& set, LitGrid& grid, const LitPoint& point) const {
    // A constant world needs no table: the lobes themselves are its best samples.
    if (!shines() || !m_environment->has_density()) return;
    const SobolPoints sequence = grid.sequence(point, 0, point.sample_count);
    for (int s = 0; s < point.sample_count; ++s) {
        const auto index = static_cast<std::uint32_t>(s);
        const Environment::Sample from = m_environment->sample(sequence(index));
        const Vec3f& wo = from.direction;
        const BsdfValue value = point.bsdf.evaluate(wo);
        if (total(value) == Vec3f(0.0f) || !(from.pdf > 0.0f)) continue;
        const float density =
            static_cast<float>(point.sample_count) * from.pdf + point.all_density(wo);
        const Vec3f seen =
            set.occlusion(grid, point, set.place_at(point, sequence.third(index)), wo);
        const BsdfValue weight = value * (seen / density);
        const float sign = LitGrid::sign(s, point.sample_count);
        if (m_environment->has_radiance())
            add_texel(grid, point, from, weight, sign);
        else
            grid.look(grid.blurred, point.index, wo, weight, sign);
    }
}

void WorldLight::meet(const LampSet& set, LitGrid& grid, const LitPoint& point,
                      const LitPlace& place, const LobeSample& sample) const {
    const Vec3f& wo = sample.wo;
    const Environment::Sample at = m_environment->at(wo);
    const float density = point.all_density(wo) + static_cast<float>(point.sample_count) * at.pdf;
    const BsdfValue weight = sample.value * (set.occlusion(grid, point, place, wo) / density);
    if (m_environment->is_constant()) {
        const BsdfValue reflected{
            weight.diffuse * m_environment->constant_radiance(RayType::Diffuse),
            weight.glossy * m_environment->constant_radiance(RayType::Glossy),
            weight.transmission * m_environment->constant_radiance(RayType::Transmission)};
        grid.reflect_world(point.index, reflected, sample.sign);
    } else if (m_environment->has_radiance() && !sample.is_narrow) {
        add_texel(grid, point, at, weight, sample.sign);
    } else {
        grid.look(grid.blurred, point.index, wo, weight, sample.sign);
    }
}

/// What a texel of the world's table sends, reflected by `weight`.
void WorldLight::add_texel(LitGrid& grid, const LitPoint& point, const Environment::Sample& from,
                           const BsdfValue& weight, float sign) const {
    const BsdfValue reflected{
        weight.diffuse * m_environment->texel_radiance(from.texel, RayType::Diffuse),
        weight.glossy * m_environment->texel_radiance(from.texel, RayType::Glossy),
        weight.transmission * m_environment->texel_radiance(from.texel, RayType::Transmission)};
    grid.reflect_world(point.index, reflected, sign);
}

void WorldLight::deliver(LitGrid& grid) const {
    if (!shines()) return;
    look(grid, grid.blurred, m_environment->texel_angle(), kBlurred);
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
