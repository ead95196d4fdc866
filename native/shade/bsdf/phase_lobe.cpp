// SPDX-License-Identifier: GPL-3.0-or-later
// Phase functions of media: Henyey and Greenstein's (1941), Rayleigh's, Draine's (2003) and that of
// Fournier and Forand (1994), in the form of Fournier and Jonasz (1999).
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

/// One whose cumulative distribution is known, but not its inverse: found by bisection of the sine
/// of half the angle, which spreads out what goes nearly straight on.
class CumulativePhase : public PhaseLobe {
  public:
    using PhaseLobe::PhaseLobe;

  protected:
    /// What goes on within the angle whose half has this sine.
    virtual double within(double half_sine) const = 0;
    float sample_cosine(float u) const override {
        double low = 0.0, high = 1.0;
        for (int step = 0; step < 32; ++step) {
            const double middle = 0.5 * (low + high);
            (within(middle) < static_cast<double>(u) ? low : high) = middle;
        }
        return static_cast<float>(1.0 - 2.0 * low * low);
    }
};

class Draine : public CumulativePhase {
  public:
    Draine(const LobeView& view, float g, float alpha)
        : CumulativePhase(view),
          m_g(static_cast<double>(std::clamp(g, -kMostAnisotropy, kMostAnisotropy))),
          m_alpha(std::max(static_cast<double>(alpha), 0.0)),
          m_scale(0.5 * (1.0 - m_g * m_g) / (1.0 + m_alpha * (1.0 + 2.0 * m_g * m_g) / 3.0)),
          m_below(integral(-1.0)) {}

  protected:
    float density(float cosine) const override {
        const double c = static_cast<double>(cosine), d = distance2(c);
        return static_cast<float>(m_scale * (1.0 + m_alpha * c * c) / (d * std::sqrt(d))) *
               (0.5f * kInversePi);
    }
    double within(double half_sine) const override {
        return 1.0 - m_scale * (integral(1.0 - 2.0 * half_sine * half_sine) - m_below);
    }

  private:
    double distance2(double cosine) const { return 1.0 + m_g * m_g - 2.0 * m_g * cosine; }
    /// Of (1 + alpha c^2) / distance^3, by the substitution of distance^2 for c.
    double integral(double cosine) const {
        const double d = distance2(cosine), root = std::sqrt(d), a = 1.0 + m_g * m_g;
        const double k = m_alpha / (4.0 * m_g * m_g);
        return ((1.0 + k * a * a) / root + 2.0 * k * a * root - k * d * root / 3.0) / m_g;
    }

    double m_g, m_alpha, m_scale, m_below;
};

/// Of particles of many sizes and one index; `backward`: part of the light that they turn by more
/// than a right angle.
class FournierForand : public CumulativePhase {
  public:
    FournierForand(const LobeView& view, float ior, float backward)
        : CumulativePhase(view),
          m_index(std::max(static_cast<double>(ior), 1.0 + 1e-4)),
          m_power(power(std::clamp(static_cast<double>(backward), 1e-5, 0.499))) {
        const double last = delta(1.0), at_last = std::pow(last, m_power);
        m_tail = (1.0 - at_last) / ((last - 1.0) * at_last);
    }

  protected:
    float density(float cosine) const override {
        const double c = static_cast<double>(cosine), s2 = 0.5 * (1.0 - c);
        if (s2 < kStraight2)
            return static_cast<float>(within(std::sqrt(kStraight2)) / kStraight2) * kInverseSphere;
        const double d = delta(s2), dv = std::pow(d, m_power), v = m_power, rest = 1.0 - d;
        const double main =
            (v * rest - (1.0 - dv) + (d * (1.0 - dv) - v * rest) / s2) / (rest * rest * dv);
        const double tail = 0.25 * m_tail * (3.0 * c * c - 1.0);
        return std::max(static_cast<float>(main + tail) * kInverseSphere, 0.0f);
    }
    double within(double half_sine) const override {
        const double s2 = half_sine * half_sine, c = 1.0 - 2.0 * s2;
        if (s2 < 1e-10) return 0.0;
        const double d = delta(s2), dv = std::pow(d, m_power);
        const double main = (1.0 - d * dv - (1.0 - dv) * s2) / ((1.0 - d) * dv);
        return main + 0.125 * m_tail * c * (1.0 - c * c);
    }

  private:
    /// Squared, the sine of half the angle below which a cosine of single precision is 1: the
    /// density, which has a pole there, is its mean.
    static constexpr double kStraight2 = 0x1p-26;

    /// Of the square of the sine of half the angle; near 1 the formulas have no digits left.
    double delta(double half_sine2) const {
        const double d = 4.0 * half_sine2 / (3.0 * (m_index - 1.0) * (m_index - 1.0));
        return std::abs(d - 1.0) < 1e-5 ? 1.0 + 1e-5 : d;
    }
    double power(double backward) const {
        const double right = delta(0.5);
        return -std::log(2.0 * backward * (right - 1.0) + 1.0) / std::log(right);
    }

    double m_index, m_power, m_tail;
};

}  // namespace

std::unique_ptr<const LobeShape> make_phase(const LobeView& view, PhaseKind kind,
                                            const Vec2f& form) {
    switch (kind) {
        case PhaseKind::Rayleigh:
            return std::make_unique<Rayleigh>(view);
        case PhaseKind::Draine:
            // As in Cycles, whatever alpha is.
            if (std::abs(form.x) < kLeastAnisotropy) return std::make_unique<Rayleigh>(view);
            return std::make_unique<Draine>(view, form.x, form.y);
        case PhaseKind::FournierForand:
            return std::make_unique<FournierForand>(view, form.x, form.y);
        case PhaseKind::HenyeyGreenstein:
            break;
    }
    return std::make_unique<HenyeyGreenstein>(view, form.x);
}

}  // namespace granita
