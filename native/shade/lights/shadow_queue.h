// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "shade/bsdf/bsdf.h"
#include "shade/lights/lit_grid.h"
#include "shade/lights/shadow_agreement.h"
#include "shade/rays/ray_scene.h"

namespace granita {

/// Light on its way from one lamp to the points of a grid: to each it arrives in the order in which
/// it was sent, but its rays are traced many at a time, as neighbouring points' rays to one lamp go
/// the same way.
class ShadowQueue {
  public:
    /// `rays` nullptr: nothing casts shadows.
    ShadowQueue(const RayScene* rays, LitGrid& grid) : m_rays(rays), m_grid(grid) {}

    /// `light`: reflected by the point where nothing is in between; `bsdf` by `radiance`: the same
    /// by its parts, of which a grid without passes wants nothing; `sign`: as LitGrid::sign.
    void send(std::size_t point, const Vec3f& light, const BsdfValue& bsdf, const Vec3f& radiance,
              float sign, const Ray& ray) {
        if (m_waiting.size() == kMost) deliver();
        // Field by field: a structure that was just put together is read in other pieces than it
        // was written in, and each such read waits (half the time of sending, without parts).
        Light& waiting = m_waiting.emplace_back();
        waiting.point = point;
        waiting.light = light;
        waiting.sign = sign;
        if (m_grid.parts) waiting.parts = bsdf * radiance;
        m_rays_waiting.push_back(ray);
    }
    /// The same where no ray is needed.
    void send(std::size_t point, const Vec3f& light, const BsdfValue& bsdf, const Vec3f& radiance,
              float sign) {
        deliver();
        take(point, light, bsdf * radiance, sign, Vec3f(1.0f));
    }
    /// What is let `through` is known, and nothing for that point is on its way.
    void take(std::size_t point, const Vec3f& light, const BsdfValue& parts, float sign,
              const Vec3f& through) {
        arrive({point, light, parts, sign}, through);
    }
    /// Tells it what rays find; nullptr: no more.
    void tell(ShadowAgreement* agreement) { m_agreement = agreement; }
    /// All that is on its way.
    void deliver() {
        if (m_waiting.empty()) return;
        m_grid.shadow_rays += m_rays_waiting.size();
        m_seen.resize(m_rays_waiting.size());
        m_rays->transmittances(m_rays_waiting, m_seen);
        for (std::size_t i = 0; i < m_waiting.size(); ++i) arrive(m_waiting[i], m_seen[i]);
        m_waiting.clear();
        m_rays_waiting.clear();
    }

  private:
    struct Light {
        std::size_t point;
        Vec3f light;
        BsdfValue parts;
        float sign;
    };
    /// A few packets: what waits stays in the first level of the cache.
    static constexpr std::size_t kMost = 128;

    void arrive(const Light& light, const Vec3f& seen) {
        if (m_agreement) m_agreement->add(light.point, seen);
        if (m_grid.sight) m_grid.sight->add(light.point, m_grid.radiance.size(), light.light, seen);
        m_grid.add(light.point, light.light * seen, light.sign);
        m_grid.add_lamp(light.point, light.parts, seen);
    }

    const RayScene* m_rays;
    LitGrid& m_grid;
    ShadowAgreement* m_agreement = nullptr;
    std::vector<Light> m_waiting;
    std::vector<Ray> m_rays_waiting;
    std::vector<Vec3f> m_seen;
};

}  // namespace granita
