// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/seen_volumes.h"

#include <vector>

#include "shade/bounces/bounced_light.h"
#include "shade/lights/direct_light.h"
#include "shade/volumes/scatter_points.h"
#include "shade/volumes/volumes.h"

namespace granita {

SeenVolumes::SeenVolumes(const Scene& scene, Volumes& volumes, const DirectLight& light,
                         const BouncedLight* bounces)
    : m_scene(scene), m_volumes(volumes), m_light(light), m_bounces(bounces) {
    volumes.set_rays(light.rays());
}

void SeenVolumes::see(std::span<const ViewRay> rays, std::span<const float> depths,
                      std::span<SeenMedium> out) const {
    std::vector<Ray> ways;
    for (const ViewRay& from : rays) {
        ways.push_back(from.ray);
        ways.back().distance = depths[from.end - 1];
    }
    RayMedia media;
    m_volumes.find(ways, media);
    std::size_t next = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        MediumWalk walk(media.of(i));
        for (; next < rays[i].end; ++next) {
            out[next].emitted = walk.advance(depths[next]);
            out[next].transmittance = walk.transmittance();
        }
    }
    if (m_volumes.scatters()) add_scattered(rays, ways, media, depths, out);
}

/// At one place of each ray.
void SeenVolumes::add_scattered(std::span<const ViewRay> rays, const std::vector<Ray>& ways,
                                const RayMedia& media, std::span<const float> depths,
                                std::span<SeenMedium> out) const {
    const std::vector<LightAnchor>& anchors = m_light.anchors();
    ScatterPoints places(0, m_scene.options.light_samples, m_volumes.phase_kinds());
    std::vector<std::size_t> seen_at;  // [places] the depth behind it
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const ScatterSampler sampler(ways[i], media.of(i), anchors);
        const Vec4f u = scatter_numbers(m_scene.options.seed, 0, rays[i].place);
        ScatterPlace place;
        if (!sampler.sample(Vec3f(u), place)) continue;
        places.add(ways[i], place, rays[i].place, u.w);
        std::size_t depth = i == 0 ? 0 : rays[i - 1].end;
        while (depths[depth] < place.distance) ++depth;
        seen_at.push_back(depth);
    }
    if (seen_at.empty()) return;
    places.finish();
    LeavingRays leaving;
    const std::vector<Vec3f> direct =
        m_light.reflect(places.points(), places.closure(), {}, nullptr, {}, nullptr,
                        m_bounces ? &leaving : nullptr);
    for (std::size_t k = 0; k < seen_at.size(); ++k) out[seen_at[k]].direct = direct[k];
    if (!m_bounces) return;
    const GatheredLight light = m_bounces->gather_scattered(leaving.rays, seen_at.size());
    for (std::size_t k = 0; k < seen_at.size(); ++k) {
        SeenMedium& seen = out[seen_at[k]];
        seen.direct += light.emitted[k];
        if (!light.world.empty()) seen.direct += total(light.world[k]);
        seen.indirect =
            glm::max(light.glossy[k] + light.mirrored[k] - light.emitted[k], Vec3f(0.0f));
    }
}

}  // namespace granita
