// SPDX-License-Identifier: GPL-3.0-or-later
// What Hair BSDF has: a highlight around the mirrored cone of the view, or around the cone behind,
// each a product of a density of the inclination and one of the azimuth (after d'Eon et al. 2011).
#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

constexpr float kHalfPi = 0.5f * kPi;
/// From here on directions along the hair have no azimuth.
constexpr float kLeastFromAxis = 0.001f;

class HairLobe : public LobeShape {
  public:
    HairLobe(const LobeView& view, const HairForm& form, bool through)
        : m_normal(view.normal),
          m_x(form.tangent),
          m_roughness(std::clamp(form.roughness, 0.001f, 1.0f)),
          m_radial(std::clamp(form.radial_roughness, 0.001f, 1.0f)),
          m_offset(-form.offset),
          m_through(through) {
        const float sine = std::clamp(glm::dot(m_x, view.wi), -1.0f, 1.0f);
        m_theta = std::asin(sine);
        const Vec3f across = view.wi - sine * m_x;
        const float length = glm::length(across);
        m_y = length > 0.0f ? across / length : Basis(m_x).x;
        m_first = std::atan((0.5f * (m_theta - kHalfPi) - m_offset) / m_roughness);
        m_width = std::atan((0.5f * (m_theta + kHalfPi) - m_offset) / m_roughness) - m_first;
        m_around = 2.0f * std::atan(kHalfPi / m_radial);
    }

    /// Lamps are asked for one side alone, as in Cycles, whose own directions go to all.
    Vec3f evaluate(const Vec3f& wo) const override {
        const bool is_behind = glm::dot(m_normal, wo) < 0.0f;
        const bool is_beyond = !m_through && glm::dot(m_y, wo) < 0.0f;
        return Vec3f(is_behind != m_through || is_beyond ? 0.0f : density(wo));
    }
    Vec3f evaluate_drawn(const Vec3f& wo) const override { return Vec3f(pdf(wo)); }
    float pdf(const Vec3f& wo) const override {
        return m_through && glm::dot(m_y, wo) > 0.0f ? 0.0f : density(wo);
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        const float t = m_roughness * std::tan(u.x * m_width + m_first);
        const float theta = 2.0f * (t + m_offset) - m_theta;
        const float phi = m_through ? kPi + m_radial * std::tan(m_around * (u.y - 0.5f))
                                    : 2.0f * std::asin(1.0f - 2.0f * u.y) * m_radial;
        const float c = std::cos(theta);
        wo = c * (std::cos(phi) * m_y - std::sin(phi) * glm::cross(m_y, m_x)) +
             std::sin(theta) * m_x;
        return kHalfPi - std::abs(theta) >= kLeastFromAxis && pdf(wo) > 0.0f;
    }
    float peak() const override {
        return 1.0f / (2.0f * m_roughness * m_width * (m_through ? m_around : 4.0f) * m_radial);
    }

  private:
    float density(const Vec3f& wo) const {
        const float sine = std::clamp(glm::dot(m_x, wo), -1.0f, 1.0f), theta = std::asin(sine);
        if (kHalfPi - std::abs(theta) < kLeastFromAxis) return 0.0f;
        const float cos_phi =
            std::clamp(glm::dot(glm::normalize(wo - sine * m_x), m_y), -1.0f, 1.0f);
        const float t = 0.5f * (theta + m_theta) - m_offset;
        const float of_theta =
            m_roughness / (2.0f * (t * t + m_roughness * m_roughness) * m_width * std::cos(theta));
        return of_theta * of_azimuth(std::acos(cos_phi));
    }
    float of_azimuth(float phi) const {
        if (!m_through) return 0.25f * std::cos(0.5f * std::min(phi / m_radial, kPi)) / m_radial;
        const float behind = kPi - phi;
        return m_radial / (m_around * (behind * behind + m_radial * m_radial));
    }

    Vec3f m_normal, m_x, m_y;  ///< y: the view, across the hair
    float m_roughness, m_radial, m_offset;
    bool m_through;
    float m_theta = 0.0f;                  ///< the view's inclination
    float m_first = 0.0f, m_width = 0.0f;  ///< angles that the tangents of t run through
    float m_around = 0.0f;
};

}  // namespace

std::unique_ptr<const LobeShape> make_hair(const LobeView& view, const HairForm& form,
                                           bool through) {
    return std::make_unique<HairLobe>(view, form, through);
}

}  // namespace granita
