// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

/// A cone of even light, and a rim in which it fades.
class Toon : public LobeShape {
  public:
    Toon(const LobeView& view, const Vec3f& axis, float size, float smooth)
        : m_normal(view.normal),
          m_axis(axis),
          m_full(std::clamp(size, 0.0f, 1.0f) * 0.5f * kPi),
          m_rim(std::clamp(smooth, 0.0f, 1.0f) * 0.5f * kPi),
          m_one_minus_cos(1.0f - std::cos(std::min(m_full + m_rim, 0.5f * kPi))) {}

    bool is_empty() const { return m_one_minus_cos <= 0.0f; }

    Vec3f evaluate(const Vec3f& wo) const override {
        if (glm::dot(m_normal, wo) <= 0.0f) return Vec3f(0.0f);
        const float cosine = glm::dot(m_axis, wo);
        if (cosine <= 1.0f - m_one_minus_cos) return Vec3f(0.0f);
        const float past = std::acos(std::min(cosine, 1.0f)) - m_full;
        return Vec3f(past < 0.0f ? density() : density() * std::max(0.0f, 1.0f - past / m_rim));
    }
    float pdf(const Vec3f& wo) const override {
        const bool inside =
            glm::dot(m_axis, wo) >= 1.0f - m_one_minus_cos && glm::dot(m_normal, wo) > 0.0f;
        return inside ? density() : 0.0f;
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        wo = Basis(m_axis).to_world(sample_cone(u, m_one_minus_cos));
        return glm::dot(m_normal, wo) > 0.0f;
    }
    float peak() const override { return density(); }

  private:
    float density() const { return 0.5f * kInversePi / m_one_minus_cos; }

    Vec3f m_normal, m_axis;
    float m_full, m_rim;  ///< radians
    float m_one_minus_cos;
};

}  // namespace

std::unique_ptr<const LobeShape> make_toon(const LobeView& view, bool glossy, float size,
                                           float smooth) {
    if (glossy && view.cos_wi <= 0.0f) return nullptr;
    const Vec3f axis = glossy ? 2.0f * view.cos_wi * view.normal - view.wi : view.normal;
    auto toon = std::make_unique<Toon>(view, axis, size, smooth);
    if (toon->is_empty()) return nullptr;
    return toon;
}

}  // namespace granita
