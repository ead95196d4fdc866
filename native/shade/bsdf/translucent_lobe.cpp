// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/sampling.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

/// A Lambert lobe of the far side.
class Translucent : public LobeShape {
  public:
    explicit Translucent(const LobeView& view) : m_down(-view.normal) {}

    Vec3f evaluate(const Vec3f& wo) const override { return Vec3f(pdf(wo)); }
    float pdf(const Vec3f& wo) const override {
        return std::max(glm::dot(m_down, wo), 0.0f) * kInversePi;
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        wo = Basis(m_down).to_world(sample_cosine_hemisphere(u));
        return glm::dot(m_down, wo) > 0.0f;
    }

  private:
    Vec3f m_down;
};

}  // namespace

std::unique_ptr<const LobeShape> make_translucent(const LobeView& view) {
    return std::make_unique<Translucent>(view);
}

}  // namespace granita
