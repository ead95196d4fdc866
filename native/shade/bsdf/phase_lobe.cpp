// SPDX-License-Identifier: GPL-3.0-or-later
// Phase functions of media: Henyey and Greenstein's (1941), and Rayleigh's.
#include <algorithm>
#include <cmath>

#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

constexpr float kInverseSphere = 0.25f * kInversePi;
/// Nearer to 0, light goes to all sides alike.
constexpr float kLeastAnisotropy = 1e-3f;
constexpr float kMostAnisotropy = 1.0f - 1e-3f;

/// A density over the sphere of the cosine between light's way before and after.
class PhaseLobe : public LobeShape {
  public:
    explicit PhaseLobe(const LobeView& view) : m_frame(-view.wi) {}

    Vec3f evaluate(const Vec3f& wo) const override { return Vec3f(pdf(wo)); }
    float pdf(const Vec3f& wo) const override { return density(glm::dot(m_frame.n, wo)); }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        const float cosine = std::clamp(sample_cosine(u.x), -1.0f, 1.0f);
        const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
        const float phi = 2.0f * kPi * u.y;
        wo = m_frame.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
        return true;
    }
    float peak() const override { return std::max(density(1.0f), density(-1.0f)); }

  protected:
    virtual float density(float cosine) const = 0;
    virtual float sample_cosine(float u) const = 0;

  private:
    Basis m_frame;  ///< n: where the view looks
};

class HenyeyGreenstein : public PhaseLobe {
  public:
    HenyeyGreenstein(const LobeView& view, float g)
        : PhaseLobe(view), m_g(std::clamp(g, -kMostAnisotropy, kMostAnisotropy)) {}

  protected:
    float density(float cosine) const override {
        if (std::abs(m_g) < kLeastAnisotropy) return kInverseSphere;
        const float d = 1.0f + m_g * m_g - 2.0f * m_g * cosine;
        return kInverseSphere * (1.0f - m_g * m_g) / (d * std::sqrt(d));
    }
    float sample_cosine(float u) const override {
        if (std::abs(m_g) < kLeastAnisotropy) return 1.0f - 2.0f * u;
        const float k = (1.0f - m_g * m_g) / (1.0f - m_g + 2.0f * m_g * u);
        return (1.0f + m_g * m_g - k * k) / (2.0f * m_g);
    }

  private:
    float m_g;
};

class Rayleigh : public PhaseLobe {
  public:
    using PhaseLobe::PhaseLobe;

  protected:
    float density(float cosine) const override {
        return 0.75f * kInverseSphere * (1.0f + cosine * cosine);
    }
    /// The root of c^3 + 3 c = 8 u - 4 (Frisvad 2011).
    float sample_cosine(float u) const override {
        const float q = 4.0f * u - 2.0f, root = std::cbrt(q + std::sqrt(1.0f + q * q));
        return root - 1.0f / root;
    }
};

}  // namespace

std::unique_ptr<const LobeShape> make_phase(const LobeView& view, PhaseKind kind, float g) {
    if (kind == PhaseKind::Rayleigh) return std::make_unique<Rayleigh>(view);
    return std::make_unique<HenyeyGreenstein>(view, g);
}

}  // namespace granita
