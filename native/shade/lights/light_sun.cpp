// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "math/sampling.h"
#include "shade/lights/light_source.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A disc in the sky, sampled uniformly by solid angle; one that is flat, uniformly on a plane.
class SunLight : public LightSource {
  public:
    SunLight(const Light& light, const LightFrame& frame)
        : m_frame(-frame.direction), m_radiance(frame.power) {
        const float half = 0.5f * std::clamp(light.sun_angle, 0.0f, kPi);
        const float s = std::sin(0.5f * half);
        m_one_minus_cos = 2.0f * s * s;
        if (is_hard()) return;
        if (light.sun_flat) {
            m_radius = std::abs(std::tan(half));  // pi / 2 is a little more in single precision
            m_pdf = 1.0f / (kPi * m_radius * m_radius);
            m_radiance *= m_pdf;
            return;
        }
        // The integral of the cosine over the disc is pi sin^2: it makes the irradiance `power`.
        m_radiance /= kPi * std::sin(half) * std::sin(half);
        m_pdf = 1.0f / (2.0f * kPi * m_one_minus_cos);
    }

    bool is_hard() const override { return m_one_minus_cos < 1e-12f; }

    void sample_all(const Vec3f&, std::span<const Vec2f> u,
                    std::span<LightSample> samples) const override {
        for (std::size_t i = 0; i < u.size(); ++i)
            samples[i] = towards(is_hard() ? m_frame.n : m_frame.to_world(sample(u[i])));
    }

    bool intersect(const Vec3f&, const Vec3f& direction, LightSample& sample) const override {
        // |a - b|^2 / 2 = 1 - cos, without its cancellation: the sun is half a degree wide.
        const Vec3f chord = direction - m_frame.n;
        if (is_hard() || 0.5f * glm::dot(chord, chord) > m_one_minus_cos) return false;
        sample = towards(direction);
        return true;
    }

    bool bound(Vec3f&, float&) const override { return false; }
    LightEmission emission() const override { return {}; }

  private:
    bool is_flat() const { return m_radius > 0.0f; }
    Vec3f sample(const Vec2f& u) const {
        if (!is_flat()) return sample_cone(u, m_one_minus_cos);
        return glm::normalize(Vec3f(m_radius * sample_disc(u), 1.0f));
    }
    LightSample towards(const Vec3f& direction) const {
        if (!is_flat()) return {direction, kInfinity, m_radiance, m_pdf};
        // Of a place on the plane a solid angle is the cube of the cosine.
        const float cosine = std::max(glm::dot(direction, m_frame.n), 1e-6f);
        const float more = 1.0f / (cosine * cosine * cosine);
        return {direction, kInfinity, m_radiance * more, m_pdf * more};
    }

    Basis m_frame;
    Vec3f m_radiance;
    float m_one_minus_cos = 0.0f, m_pdf = 1.0f, m_radius = 0.0f;
};

}  // namespace

std::unique_ptr<LightSource> make_sun_light(const Light& light, const LightFrame& frame) {
    return std::make_unique<SunLight>(light, frame);
}

}  // namespace granita
