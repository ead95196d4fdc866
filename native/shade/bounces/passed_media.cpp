// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/passed_media.h"

#include <algorithm>

#include "math/luminance.h"
#include "shade/volumes/scatter_points.h"

namespace granita {

void PassedMedia::find(const std::vector<RayScene::Met>& met, std::vector<Ray>& rays) {
    for (const RayScene::Met& one : met) rays[one.ray].distance = one.hit.distance;
    m_volumes.find(rays, m_media);
    m_emitted.resize(rays.size());
    m_transmittance.resize(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        MediumWalk walk(m_media.of(i));
        m_emitted[i] = walk.advance(rays[i].distance);
        m_transmittance[i] = walk.transmittance();
    }
}

void PassedMedia::pass(std::span<const Ray> rays, std::vector<BouncedPath>& paths,
                       std::vector<RayScene::Met>& met, std::vector<std::uint8_t>& meets_nothing) {
    m_scattering.clear();
    std::vector<std::uint8_t> has_met(paths.size(), 0), is_scattered(paths.size(), 0);
    for (const RayScene::Met& one : met) has_met[one.ray] = 1;
    for (std::uint32_t i = 0; i < paths.size(); ++i) {
        BouncedPath& path = paths[i];
        if (!has_met[i] && !path.next.world.shines()) meets_nothing[i] = 0;
        const bool has_end = has_met[i] || meets_nothing[i];
        const float passing = has_end ? mean_size(m_transmittance[i]) : 0.0f;
        const float scattered = scatter(path, rays[i], i, passing);
        if (scattered < 1.0f) {
            path.next.weight *= m_transmittance[i] / (1.0f - scattered);
            continue;
        }
        meets_nothing[i] = 0;
        is_scattered[i] = 1;
    }
    std::erase_if(met, [&](const RayScene::Met& one) { return is_scattered[one.ray] != 0; });
    std::ranges::stable_sort(m_scattering, {},
                             [&](const Scattering& s) { return paths[s.path].depth; });
}

/// 1 where the way is gone on with at a place that scatters light, else how likely that was;
/// `passing`: mean of what passes to where it ends.
float PassedMedia::scatter(const BouncedPath& path, const Ray& ray, std::uint32_t i,
                           float passing) {
    if (!m_volumes.scatters() || !path.is_lit(m_limits) || path.met_weight == 0.0f) return 0.0f;
    const ScatterSampler sampler(ray, m_media.of(i), {});
    const float chance = sampler.scattered() / (sampler.scattered() + passing);
    if (!(chance > 0.0f)) return 0.0f;
    const auto step = static_cast<std::uint32_t>(path.depth + 256 * path.passed);
    const Vec4f u = scatter_numbers(m_seed, step, path.next.place);
    if (!(u.z < chance)) return chance;
    Scattering made{i, {}, u.w};
    if (sampler.sample(Vec3f(u), made.place)) {
        made.place.weight *= path.met_weight / chance;
        m_scattering.push_back(made);
    }
    return 1.0f;
}

}  // namespace granita
