// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/lights/light_source.h"

namespace granita {
namespace {

float smoothstep(float t) {
    const float c = std::clamp(t, 0.0f, 1.0f);
    return c * c * (3.0f - 2.0f * c);
}

/// Rows are the unit axes: the inverse of an unsheared matrix but for its scale.
Mat3d without_scale(const Mat3d& axes) {
    return glm::transpose(
        Mat3d(glm::normalize(axes[0]), glm::normalize(axes[1]), glm::normalize(axes[2])));
}

/// The cone of a spot, in the light's own space: a scaled light has an elliptic cone.
class SpotCone {
  public:
    SpotCone(const Light& light, const LightFrame& frame)
        : m_light_from_world(light.spot_cosine ? without_scale(frame.axes)
                                               : glm::inverse(frame.axes)),
          m_cos_half(std::cos(0.5f * light.spot_size)),
          m_smooth(std::max((1.0f - m_cos_half) * light.spot_blend, 1e-7f)),
          m_cosine(light.spot_cosine),
          m_widest(0.5f * light.spot_size) {
        if (m_cosine) return;
        // A cone through a sheared matrix is bound by nothing simpler than all directions.
        const Vec3d &x = frame.axes[0], &y = frame.axes[1], &z = frame.axes[2];
        const double across = std::max(glm::length(x), glm::length(y)), along = glm::length(z);
        const double skew = std::max(
            {std::abs(glm::dot(x, y)), std::abs(glm::dot(x, z)), std::abs(glm::dot(y, z))});
        const bool even = skew < 1e-6 * across * across && skew < 1e-6 * along * along;
        if (!even || m_cos_half <= 0.0f)
            m_widest = even && across == along ? m_widest : kPi;
        else
            m_widest = static_cast<float>(std::atan(std::tan(m_widest) * across / along));
    }

    /// No light leaves farther from the axis; radians.
    float widest() const { return m_widest; }

    /// Of light that leaves along `direction` (unit, world axes).
    float attenuation(const Vec3f& direction) const {
        const Vec3f local = glm::normalize(Vec3f(m_light_from_world * Vec3d(direction)));
        const float fade = smoothstep((-local.z - m_cos_half) / m_smooth);
        return m_cosine ? fade * std::max(-local.z, 0.0f) : fade;
    }

  private:
    Mat3d m_light_from_world;
    float m_cos_half, m_smooth;
    bool m_cosine;
    float m_widest;
};

class PointLight : public LightSource {
  public:
    PointLight(const Light& light, const LightFrame& frame)
        : m_position(frame.position),
          m_radius(std::max(light.radius, 0.0f)),
          m_sphere(!light.soft_falloff),
          m_axis(frame.direction),
          m_intensity(frame.power * (0.25f * kInversePi)) {
        if (light.kind == LightKind::Spot) m_cone = std::make_unique<SpotCone>(light, frame);
        if (!is_hard()) m_radiance = m_intensity / (kPi * m_radius * m_radius);
    }

    bool is_hard() const override { return m_radius <= 0.0f; }

    void sample_all(const Vec3f& p, std::span<const Vec2f> u,
                    std::span<LightSample> samples) const override {
        for (std::size_t i = 0; i < u.size(); ++i)
            if (!sample_one(p, u[i], samples[i])) samples[i].pdf = 0.0f;
    }

    bool intersect(const Vec3f& p, const Vec3f& direction, LightSample& sample) const override {
        if (is_hard()) return false;
        const Vec3f to_center = m_position - p;
        const float d2 = glm::dot(to_center, to_center);
        if (d2 <= 0.0f) return false;
        return m_sphere ? meet_sphere(to_center, d2, direction, sample)
                        : meet_disc(to_center, d2, direction, sample);
    }

    bool bound(Vec3f& center, float& radius) const override {
        center = m_position;
        radius = m_radius;
        return true;
    }

    LightEmission emission() const override {
        LightEmission out;
        out.intensity = mean_size(m_intensity);
        out.near2 = m_radius * m_radius;
        if (!m_cone) return out;
        out.axis = m_axis;
        out.cone = m_cone->widest();
        out.fall = 0.0f;
        return out;
    }

  private:
    bool sample_one(const Vec3f& p, const Vec2f& u, LightSample& sample) const {
        const Vec3f to_center = m_position - p;
        const float d2 = glm::dot(to_center, to_center);
        if (d2 <= 0.0f) return false;
        const Vec3f axis = to_center / std::sqrt(d2);
        if (is_hard()) {
            sample = {axis, std::sqrt(d2), m_intensity / d2, 1.0f};
            return shade_cone(sample);
        }
        const Basis frame(axis);
        const float r2 = m_radius * m_radius;
        if (m_sphere) {
            const Vec3f local = d2 > r2 ? sample_cone(u, one_minus_cos(d2)) : sample_sphere(u);
            return intersect(p, frame.to_world(local), sample);
        }
        const Vec2f disc = sample_disc(u) * m_radius;
        const Vec3f q = to_center + disc.x * frame.x + disc.y * frame.y;
        const float distance = glm::length(q);
        return disc_sample(q / distance, distance, std::sqrt(d2) / distance, sample);
    }

    static Vec3f sample_sphere(const Vec2f& u) {
        const float z = 1.0f - 2.0f * u.x, s = std::sqrt(std::max(0.0f, 1.0f - z * z));
        return {s * std::cos(2.0f * kPi * u.y), s * std::sin(2.0f * kPi * u.y), z};
    }
    float one_minus_cos(float d2) const {
        const float sin2 = m_radius * m_radius / d2;
        return sin2 / (1.0f + std::sqrt(std::max(0.0f, 1.0f - sin2)));
    }

    bool shade_cone(LightSample& sample) const {
        if (!m_cone) return true;
        const float fade = m_cone->attenuation(-sample.direction);
        sample.radiance *= fade;
        return fade > 0.0f;
    }

    bool disc_sample(const Vec3f& direction, float distance, float cos_disc,
                     LightSample& sample) const {
        const float area = kPi * m_radius * m_radius;
        sample = {direction, distance, m_radiance, distance * distance / (cos_disc * area)};
        return shade_cone(sample);
    }

    bool meet_disc(const Vec3f& to_center, float d2, const Vec3f& direction,
                   LightSample& sample) const {
        const float cos_disc = glm::dot(direction, to_center) / std::sqrt(d2);
        if (cos_disc <= 0.0f) return false;
        const float distance = std::sqrt(d2) / cos_disc;
        const Vec3f off = direction * distance - to_center;
        if (glm::dot(off, off) > m_radius * m_radius) return false;
        return disc_sample(direction, distance, cos_disc, sample);
    }

    bool meet_sphere(const Vec3f& to_center, float d2, const Vec3f& direction,
                     LightSample& sample) const {
        const float r2 = m_radius * m_radius;
        const float along = glm::dot(direction, to_center);
        const Vec3f off = to_center - along * direction;
        const float half2 = r2 - glm::dot(off, off);
        if (half2 < 0.0f) return false;
        const bool outside = d2 > r2;
        const float distance = along + (outside ? -std::sqrt(half2) : std::sqrt(half2));
        if (distance <= 0.0f) return false;
        const float solid_angle = outside ? 2.0f * kPi * one_minus_cos(d2) : 4.0f * kPi;
        sample = {direction, distance, m_radiance, 1.0f / solid_angle};
        return shade_cone(sample);
    }

    Vec3f m_position;
    float m_radius;
    bool m_sphere;
    Vec3f m_axis, m_intensity, m_radiance{0.0f};
    std::unique_ptr<SpotCone> m_cone;
};

}  // namespace

std::unique_ptr<LightSource> make_point_light(const Light& light, const LightFrame& frame) {
    return std::make_unique<PointLight>(light, frame);
}

}  // namespace granita
