// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/lobe_shape.h"
#include "shade/bsdf/microfacet.h"

namespace granita {
namespace {

/// What GGX facets of the far side mirror, of the view mirrored at the sheet; nothing is lost
/// between them (Kulla and Conty 2017).
class ThinGlass : public LobeShape {
  public:
    ThinGlass(const LobeView& view, float alpha)
        : m_view(view),
          m_frame(view.normal),
          m_alpha(alpha),
          m_lambda(ggx_lambda(alpha, view.cos_wi)),
          m_gain(1.0f / GgxAlbedo::shared().directional(std::sqrt(alpha), view.cos_wi)) {}

    Vec3f evaluate(const Vec3f& wo) const override {
        const Vec3f mirrored = across(wo);
        const float cos_o = glm::dot(m_view.normal, mirrored);
        if (cos_o <= 0.0f) return Vec3f(0.0f);
        const float masking = 1.0f + m_lambda + ggx_lambda(m_alpha, cos_o);
        return Vec3f(m_gain * 0.25f * density(mirrored) / (m_view.cos_wi * masking));
    }
    float pdf(const Vec3f& wo) const override {
        const Vec3f mirrored = across(wo);
        if (glm::dot(m_view.normal, mirrored) <= 0.0f) return 0.0f;
        return 0.25f * density(mirrored) / (m_view.cos_wi * (1.0f + m_lambda));
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        const Vec3f half =
            m_frame.to_world(sample_ggx_visible(m_frame.to_local(m_view.wi), m_alpha, u));
        const Vec3f mirrored = glm::normalize(2.0f * glm::dot(half, m_view.wi) * half - m_view.wi);
        wo = across(mirrored);
        return glm::dot(m_view.normal, mirrored) > 0.0f;
    }
    float peak() const override {
        return m_gain * 0.25f * ggx_density(m_alpha, 0.0f) / m_view.cos_wi;
    }

  private:
    Vec3f across(const Vec3f& w) const {
        return w - 2.0f * glm::dot(w, m_view.normal) * m_view.normal;
    }
    float density(const Vec3f& mirrored) const {
        const Vec3f half = glm::normalize(m_view.wi + mirrored);
        return ggx_density(m_alpha, squared_sine(m_view.normal, half));
    }

    LobeView m_view;
    Basis m_frame;
    float m_alpha, m_lambda, m_gain;
};

}  // namespace

std::unique_ptr<const LobeShape> make_thin_glass(const LobeView& view, float roughness) {
    if (view.cos_wi <= 0.0f) return nullptr;
    return std::make_unique<ThinGlass>(view, roughness * roughness);
}

}  // namespace granita
