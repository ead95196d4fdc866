// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_lamp.h"

#include <algorithm>
#include <utility>

namespace granita {
namespace {

/// Places of a lamp that moves.  A step between two of them is a 256th of its way: a path across a
/// frame of 4096 pixels moves a shadow by 16 of them, far below its penumbra's own blur.
constexpr int kPlaces = 256;

bool varies_over_time(const Light& light) {
    const auto& m = light.world_from_light;
    const auto& e = light.energy_knots;
    return std::any_of(m.begin(), m.end(), [&](const Mat4d& knot) { return knot != m[0]; }) ||
           std::any_of(e.begin(), e.end(), [&](float knot) { return knot != e[0]; });
}

}  // namespace

Lamp::Lamp(const Light& light, float frame_time, const Vec3d& origin, LampPattern pattern)
    : m_pattern(std::move(pattern)),
      m_lifespan(light.lifespan),
      m_casts_shadow(light.casts_shadow),
      m_diffuse(light.visible_diffuse ? light.diffuse_factor : 0.0f),
      m_glossy(light.visible_glossy ? light.specular_factor : 0.0f),
      m_transmission(light.visible_transmission ? light.specular_factor : 0.0f),
      m_volume(light.visible_volume ? light.specular_factor : 0.0f),
      m_most_bounces(light.most_bounces),
      m_receiver_set(light.receiver_set),
      m_blocker_set(light.blocker_set) {
    const int places = varies_over_time(light) ? kPlaces : 1;
    for (int k = 0; k < places; ++k) {
        const float time = places > 1 ? (static_cast<float>(k) + 0.5f) / kPlaces : frame_time;
        const LightFrame frame = light_frame(light, time, origin);
        m_sources.push_back(make_light_source(light, frame));
        if (m_pattern.pattern) m_frames.push_back(frame);
        m_hard = m_hard && m_sources.back()->is_hard();
    }
}

Lamp::Lamp(MovingTriangle triangle, const Instance& instance,
           std::shared_ptr<const LightPattern> pattern)
    : m_pattern{std::move(pattern)},
      m_lifespan(instance.lifespan),
      m_hard(false),
      m_casts_shadow(true),
      m_is_surface(true),
      m_target(triangle.target),
      m_diffuse(instance.visible_diffuse ? 1.0f : 0.0f),
      m_glossy(instance.visible_glossy ? 1.0f : 0.0f),
      m_transmission(instance.visible_transmission ? 1.0f : 0.0f),
      m_volume(instance.visible_volume ? 1.0f : 0.0f),
      m_receiver_set(instance.receiver_set),
      m_blocker_set(instance.blocker_set) {
    if (triangle.is_still())
        m_sources.push_back(std::make_unique<TriangleLight>(triangle.at(0.0f)));
    else
        m_moving = std::make_unique<const MovingTriangle>(std::move(triangle));
}

LightBound Lamp::bound_of(const LightSource& source) const {
    LightBound here;
    LightEmission emission = source.emission();
    emission.intensity *= m_pattern.largest;
    here.box = source.box();
    here.axis = emission.axis;
    here.cone = emission.cone;
    here.fall = emission.fall;
    here.near2 = emission.near2;
    here.diffuse = emission.intensity * m_diffuse;
    here.glossy = emission.intensity * std::max({m_glossy, m_transmission, m_volume});
    here.sets = m_receiver_set < 0 ? ~0ULL : 1ULL << m_receiver_set;
    here.is_face = m_is_surface;
    return here;
}

bool Lamp::bound(LightBound& out) const {
    out = {};
    out.is_face = m_is_surface;
    if (m_moving)
        m_moving->at_knots([&](const TriangleLight& place) { out.add_time(bound_of(place)); });
    for (const auto& source : m_sources) {
        Vec3f center;
        float radius;
        if (!source->bound(center, radius)) return false;
        out.add_time(bound_of(*source));
    }
    return true;
}

}  // namespace granita
