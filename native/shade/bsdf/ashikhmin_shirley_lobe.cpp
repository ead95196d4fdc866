// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

float exponent_of(float alpha) {
    const float bounded = std::clamp(alpha, 1e-4f, 1.0f);
    return 2.0f / (bounded * bounded) - 2.0f;
}

class AshikhminShirley : public LobeShape {
  public:
    AshikhminShirley(const LobeView& view, const Vec3f& x, const Vec2f& alpha)
        : m_view(view),
          m_x(x),
          m_y(glm::cross(view.normal, x)),
          m_n_x(exponent_of(alpha.x)),
          m_n_y(exponent_of(alpha.y)) {}

    Vec3f evaluate(const Vec3f& wo) const override {
        const float cos_o = glm::dot(m_view.normal, wo);
        if (cos_o <= 0.0f) return Vec3f(0.0f);
        return Vec3f(pdf(wo) * cos_o / std::max({m_view.cos_wi, cos_o, 1e-6f}));
    }
    float pdf(const Vec3f& wo) const override {
        if (glm::dot(m_view.normal, wo) <= 0.0f) return 0.0f;
        const Vec3f half = glm::normalize(m_view.wi + wo);
        const float cos_h = std::max(glm::dot(half, m_view.normal), 1e-6f);
        const float half_wi = std::max(glm::dot(half, m_view.wi), 1e-6f);
        const float x = glm::dot(half, m_x), y = glm::dot(half, m_y), across = x * x + y * y;
        const float exponent = across > 0.0f ? (m_n_x * x * x + m_n_y * y * y) / across : 0.0f;
        return std::sqrt((m_n_x + 1.0f) * (m_n_y + 1.0f)) * (0.125f * kInversePi) *
               std::pow(cos_h, exponent) / half_wi;
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        // Four quadrants, alike; in one the ellipse's angle by its tangent.
        const float turn = 4.0f * u.x, quadrant = std::floor(turn);
        const float in_quadrant = std::min(turn - quadrant, 0.99999994f);
        const bool odd = static_cast<int>(quadrant) % 2 != 0;
        const float phi =
            std::atan(std::sqrt((m_n_x + 1.0f) / (m_n_y + 1.0f)) *
                      std::tan(0.5f * kPi * (odd ? 1.0f - in_quadrant : in_quadrant)));
        const float c = std::cos(phi), s = std::sin(phi);
        const float cos_h = std::pow(1.0f - u.y, 1.0f / (m_n_x * c * c + m_n_y * s * s + 1.0f));
        const float sin_h = std::sqrt(std::max(0.0f, 1.0f - cos_h * cos_h));
        const float x = quadrant == 1.0f || quadrant == 2.0f ? -c : c;
        const float y = quadrant >= 2.0f ? -s : s;
        const Vec3f half = sin_h * (x * m_x + y * m_y) + cos_h * m_view.normal;
        wo = glm::normalize(2.0f * glm::dot(half, m_view.wi) * half - m_view.wi);
        return glm::dot(half, m_view.wi) > 0.0f && glm::dot(m_view.normal, wo) > 0.0f &&
               glm::dot(m_view.geometric_normal, wo) >= 0.0f;
    }

  private:
    LobeView m_view;
    Vec3f m_x, m_y;
    float m_n_x, m_n_y;
};

}  // namespace

std::unique_ptr<const LobeShape> make_ashikhmin_shirley(const LobeView& view, const Vec3f& x,
                                                        const Vec2f& alpha) {
    if (view.cos_wi <= 0.0f) return nullptr;
    return std::make_unique<AshikhminShirley>(view, x, alpha);
}

}  // namespace granita
