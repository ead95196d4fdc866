// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth that shines where it is grazed: three models of it, as three generations of Cycles have
// them.
#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/lobe_shape.h"
#include "shade/bsdf/sheen_table.h"

namespace granita {
namespace {

/// A cosine, linearly transformed: w = A^-1 wo is spread as the cosine is (Heitz et al. 2016).
class Sheen : public LobeShape {
  public:
    Sheen(const LobeView& view, const SheenFit& fit) : m_fit(fit), m_z(view.normal) {
        const Vec3f across = glm::cross(view.normal, view.wi);
        const float length = glm::length(across);
        m_y = length > 1e-6f ? across / length : Basis(view.normal).x;
        m_x = glm::cross(m_y, m_z);
    }

    Vec3f evaluate(const Vec3f& wo) const override { return Vec3f(m_fit.albedo * pdf(wo)); }
    float pdf(const Vec3f& wo) const override {
        const float z = glm::dot(m_z, wo);
        if (z <= 0.0f) return 0.0f;
        const float x = m_fit.a * glm::dot(m_x, wo) + m_fit.b * z, y = m_fit.a * glm::dot(m_y, wo);
        const float ratio = m_fit.a / (x * x + y * y + z * z);
        return kInversePi * z * ratio * ratio;
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        const Vec3f w = sample_cosine_hemisphere(u);
        const Vec3f turned(w.x - w.z * m_fit.b, w.y, w.z * m_fit.a);
        wo = glm::normalize(turned.x * m_x + turned.y * m_y + turned.z * m_z);
        return turned.z > 0.0f;
    }
    Vec3f albedo() const override { return Vec3f(m_fit.albedo); }
    float peak() const override {
        const float narrow = std::min(std::abs(m_fit.a), 1.0f);
        return m_fit.albedo * kInversePi / (narrow * narrow);
    }

  private:
    SheenFit m_fit;
    Vec3f m_x, m_y, m_z;
};

/// Of light that grazes the half vector.
class GrazingSheen : public LobeShape {
  public:
    explicit GrazingSheen(const LobeView& view) : m_view(view) {}

    Vec3f evaluate(const Vec3f& wo) const override {
        const float cos_o = glm::dot(m_view.normal, wo);
        if (cos_o <= 0.0f || m_view.cos_wi < 0.0f) return Vec3f(0.0f);
        return Vec3f(schlick_weight(glm::dot(wo, glm::normalize(m_view.wi + wo))) * cos_o);
    }
    float pdf(const Vec3f& wo) const override {
        return std::max(glm::dot(m_view.normal, wo), 0.0f) * kInversePi;
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        wo = Basis(m_view.normal).to_world(sample_cosine_hemisphere(u));
        return glm::dot(m_view.normal, wo) > 0.0f;
    }
    /// As Cycles guesses it, with light from where the view is.
    Vec3f albedo() const override {
        return Vec3f(schlick_weight(m_view.cos_wi) * std::max(m_view.cos_wi, 0.0f));
    }
    float peak() const override { return 1.0f; }

  private:
    LobeView m_view;
};

/// Microfacets that stand upright.
class Velvet : public LobeShape {
  public:
    Velvet(const LobeView& view, float sigma) : m_view(view) {
        const float bounded = std::clamp(sigma, 0.01f, 1.0f);
        m_inverse2 = 1.0f / (bounded * bounded);
    }

    Vec3f evaluate(const Vec3f& wo) const override {
        const float cos_o = glm::dot(m_view.normal, wo);
        if (cos_o <= 0.0f || m_view.cos_wi <= 0.0f) return Vec3f(0.0f);
        const Vec3f half = glm::normalize(m_view.wi + wo);
        const float cos_h = glm::dot(m_view.normal, half), half_wi = glm::dot(m_view.wi, half);
        if (cos_h >= 1.0f - 1e-5f || half_wi <= 1e-5f) return Vec3f(0.0f);
        const float sin2 = 1.0f - cos_h * cos_h;
        const float density =
            std::exp(-cos_h * cos_h / sin2 * m_inverse2) * m_inverse2 * kInversePi / (sin2 * sin2);
        const float groove = 2.0f * std::max(cos_h / half_wi, 1e-5f);
        const float masking = std::min(1.0f, groove * std::min(m_view.cos_wi, cos_o));
        return Vec3f(0.25f * density * masking / m_view.cos_wi);
    }
    float pdf(const Vec3f& wo) const override {
        return glm::dot(m_view.normal, wo) > 0.0f ? 0.5f * kInversePi : 0.0f;
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        wo = Basis(m_view.normal).to_world(sample_cone(u, 1.0f));
        return glm::dot(m_view.normal, wo) > 0.0f;
    }
    float peak() const override { return m_inverse2 * kInversePi; }

  private:
    LobeView m_view;
    float m_inverse2;
};

}  // namespace

std::unique_ptr<const LobeShape> make_sheen(const LobeView& view, float roughness) {
    const SheenFit fit = sheen_fit(view.cos_wi, roughness);
    if (std::abs(fit.a) < 1e-5f || fit.albedo < 1e-5f) return nullptr;
    return std::make_unique<Sheen>(view, fit);
}

std::unique_ptr<const LobeShape> make_grazing_sheen(const LobeView& view) {
    return std::make_unique<GrazingSheen>(view);
}

std::unique_ptr<const LobeShape> make_velvet(const LobeView& view, float sigma) {
    return std::make_unique<Velvet>(view, sigma);
}

}  // namespace granita
