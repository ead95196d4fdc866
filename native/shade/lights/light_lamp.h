// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "scene/scene.h"
#include "shade/bsdf/bsdf.h"
#include "shade/lights/light_bound.h"
#include "shade/lights/light_pattern.h"
#include "shade/lights/light_source.h"
#include "shade/lights/light_triangle.h"

namespace granita {

/// A light of the scene over the shutter, with what it may do to whom.
class Lamp {
  public:
    /// `origin`: the camera's world position at the frame time.
    Lamp(const Light& light, float frame_time, const Vec3d& origin, LampPattern pattern = {});
    /// A triangle of an instance that shines.
    /// `pattern`: where its light varies; the triangle's own is then a mean.
    Lamp(MovingTriangle triangle, const Instance& instance,
         std::shared_ptr<const LightPattern> pattern = nullptr);

    /// Whether its place or its strength changes within the shutter.
    bool varies() const { return m_moving || m_sources.size() > 1 || !m_lifespan.is_whole(); }
    /// Whether it is there.
    bool exists(float time) const { return m_lifespan.contains(time); }
    /// Without a size at all times.
    bool is_hard() const { return m_hard; }
    bool casts_shadow() const { return m_casts_shadow; }
    /// Whether rays meet it, which are to end before it.
    bool is_surface() const { return m_is_surface; }
    /// Of a triangle that stands still; nullptr: it is none.
    const TriangleLight::Corners* corners() const {
        return m_is_surface && !m_moving
                   ? &static_cast<const TriangleLight&>(*m_sources[0]).corners()
                   : nullptr;
    }
    /// Of a surface: what rays meet of it.
    const RayTarget& target() const { return m_target; }
    /// Whether it lights an instance of that mask (Instance::receives).
    bool lights(std::uint64_t receives) const { return in_light_set(receives, m_receiver_set); }
    /// Whether points ask it after so many bounces.  Samples of lobes meet it after any (Cycles).
    bool is_asked(int depth) const { return depth <= m_most_bounces; }
    int most_bounces() const { return m_most_bounces; }
    int blocker_set() const { return m_blocker_set; }
    /// Whether samples of lobes may meet it: diffuse ones where it is not asked.
    bool meets_lobes(int depth) const {
        return m_glossy > 0.0f || m_transmission > 0.0f || m_volume > 0.0f || !is_asked(depth);
    }
    /// Of its nodes, which colour what sample_all() and meets() give; nullptr: there are none.
    const LightPattern* pattern() const { return m_pattern.pattern.get(); }
    /// For the pattern: its sample that goes to `p`.
    PatternSample patterned(float time, const Vec3f& p, LightSample& sample) const {
        const LightFrame* frame = m_is_surface ? nullptr : &m_frames[at(time, m_frames.size())];
        return {frame, p, &sample, time, m_target, kFootprint * sample.distance};
    }
    /// LightSource::sample_all at a time.
    void sample_all(float time, const Vec3f& p, std::span<const Vec2f> u,
                    std::span<LightSample> samples) const {
        if (m_moving)
            m_moving->at(time).sample_all(p, u, samples);
        else
            at(time).sample_all(p, u, samples);
    }
    bool sample(float time, const Vec3f& p, const Vec2f& u, LightSample& sample) const {
        sample_all(time, p, {&u, 1}, {&sample, 1});
        return sample.pdf > 0.0f;
    }
    /// What a ray of that time meets of it: LightSource::intersect.
    bool meets(float time, const Vec3f& p, const Vec3f& direction, LightSample& sample) const {
        if (!exists(time)) return false;
        return m_moving ? m_moving->at(time).intersect(p, direction, sample)
                        : at(time).intersect(p, direction, sample);
    }
    /// LightSource::separates at a time.
    bool separates(float time, const Vec3f& p, const Vec3f& start) const {
        if (!m_is_surface) return false;
        return m_moving ? m_moving->at(time).separates(p, start) : at(time).separates(p, start);
    }
    /// Of one that does not vary: LightSource::bound.
    bool bound(Vec3f& center, float& radius) const { return at(0.0f).bound(center, radius); }
    /// Whether it has a place, and then a bound on it and on what it sheds over the shutter.
    bool bound(LightBound& out) const;
    /// Light that is sent on, by the lobes that see this lamp; `in_medium`: phase functions.
    BsdfValue apply(const BsdfValue& value, bool in_medium) const {
        return {value.diffuse * m_diffuse, value.glossy * m_glossy,
                value.transmission * (in_medium ? m_volume : m_transmission)};
    }

  private:
    /// Of what a sample sees of a surface, radians: texels that are no smaller are interpolated, as
    /// in Cycles, and not averaged.
    static constexpr float kFootprint = 1.0f / 4096.0f;

    /// Of equal parts of the shutter, that which holds a time.
    static std::size_t at(float time, std::size_t count) {
        const auto place = static_cast<std::size_t>(time * static_cast<float>(count));
        return place < count ? place : count - 1;
    }
    const LightSource& at(float time) const { return *m_sources[at(time, m_sources.size())]; }
    LightBound bound_of(const LightSource& source) const;

    std::vector<std::unique_ptr<LightSource>> m_sources;  ///< one, or at equal parts of the shutter
    std::unique_ptr<const MovingTriangle> m_moving;       ///< instead of these
    LampPattern m_pattern;
    std::vector<LightFrame> m_frames;  ///< [sources] of a lamp that has a pattern
    Lifespan m_lifespan;
    bool m_hard = true, m_casts_shadow, m_is_surface = false;
    RayTarget m_target;
    float m_diffuse, m_glossy, m_transmission, m_volume;
    int m_most_bounces = Light::kAnyBounces, m_receiver_set, m_blocker_set;
};

}  // namespace granita
