// SPDX-License-Identifier: GPL-3.0-or-later
// Chiang, Bitterli, Tappan and Burley 2016, "A Practical and Controllable Hair and Fur Model for
// Production Path Tracing": light that is reflected (R), goes through (TT), is reflected inside
// (TRT), or more often, each a longitudinal times an azimuthal density.
#include <algorithm>
#include <array>
#include <cmath>

#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/hair_color.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

constexpr int kPaths = 4;

float cosine_of(float sine) {
    return std::sqrt(std::max(0.0f, 1.0f - sine * sine));
}

float angle_in_circle(float a) {
    return a - 2.0f * kPi * std::floor((a + kPi) / (2.0f * kPi));
}

/// Logarithm of the modified Bessel function of order 0.
float log_bessel(float x) {
    if (x > 12.0f) return x + 0.5f * (1.0f / (8.0f * x) - std::log(2.0f * kPi) - std::log(x));
    float sum = 1.0f, term = 1.0f;
    for (int i = 1; i < 30 && term > 1e-8f * sum; ++i) {
        term *= 0.25f * x * x / static_cast<float>(i * i);
        sum += term;
    }
    return std::log(sum);
}

/// Of inclinations, per cosine; v: variance.
float longitudinal(float sin_i, float cos_i, float sin_o, float cos_o, float v) {
    const float inverse = 1.0f / v, a = cos_i * cos_o * inverse, b = sin_i * sin_o * inverse;
    if (v <= 0.1f)  // sinh(1 / v) is exp(1 / v) / 2
        return std::exp(log_bessel(a) - b - inverse + std::log(inverse));
    return std::exp(log_bessel(a) - b) / (2.0f * v * std::sinh(inverse));
}

/// The logistic distribution cut to a full turn.
struct TrimmedLogistic {
    float scale;

    float below(float x) const { return 1.0f / (1.0f + std::exp(std::min(-x / scale, 80.0f))); }
    float density(float x) const {
        const float e = std::exp(-std::abs(x) / scale);
        return e / (scale * (1.0f + e) * (1.0f + e)) / (1.0f - 2.0f * below(-kPi));
    }
    float sample(float u) const {
        const float first = below(-kPi), at = u * (1.0f - 2.0f * first) + first;
        return std::clamp(-scale * std::log(1.0f / at - 1.0f), -kPi, kPi);
    }
};

/// Two numbers of one, by its odd and even bits.
Vec2f split(float u) {
    const auto bits = static_cast<std::uint32_t>(u * 16777216.0f);
    std::uint32_t even = 0, odd = 0;
    for (int i = 0; i < 12; ++i) {
        even |= (bits >> (2 * i) & 1u) << i;
        odd |= (bits >> (2 * i + 1) & 1u) << i;
    }
    return (Vec2f(static_cast<float>(odd), static_cast<float>(even)) + 0.5f) / 4096.0f;
}

class PrincipledHair : public LobeShape {
  public:
    PrincipledHair(const LobeView& view, const HairForm& form) : m_x(form.tangent) {
        const Vec3f y = glm::cross(m_x, view.wi);
        const float length = glm::length(y);
        m_y = length > 1e-6f ? y / length : Basis(m_x).x;
        m_z = glm::cross(m_x, m_y);
        set_roughness(form);
        // Where across the hair the view meets it: the sine of the tube's normal.
        const float h = std::clamp(glm::dot(glm::cross(view.normal, m_x), m_z), -1.0f, 1.0f);
        m_sin_o = std::clamp(glm::dot(view.wi, m_x), -1.0f, 1.0f);
        m_cos_o = cosine_of(m_sin_o);
        m_phi_o = std::atan2(glm::dot(view.wi, m_z), glm::dot(view.wi, m_y));
        m_gamma_o = std::asin(h);
        const float eta = std::max(form.ior, 1.0001f);
        const float sin_gamma_t = h * m_cos_o / std::sqrt(eta * eta - m_sin_o * m_sin_o);
        m_gamma_t = std::asin(std::clamp(sin_gamma_t, -1.0f, 1.0f));
        const float way = 2.0f * cosine_of(sin_gamma_t) / cosine_of(m_sin_o / eta);
        const float reflected = fresnel_dielectric(m_cos_o * cosine_of(h), eta);
        attenuate(reflected, glm::exp(-form.sigma * way));
        m_albedo = glm::exp(-glm::sqrt(form.sigma) * hair_absorption_scale(4.0f * m_variance[1])) +
                   reflected;
        tilt(-form.offset);
    }

    Vec3f evaluate(const Vec3f& wo) const override {
        const Densities d = densities(wo);
        Vec3f sum(0.0f);
        for (int p = 0; p < kPaths; ++p) sum += m_attenuation[p] * d[p];
        return sum;
    }
    float pdf(const Vec3f& wo) const override {
        const Densities d = densities(wo);
        float sum = 0.0f;
        for (int p = 0; p < kPaths; ++p) sum += m_share[p] * d[p];
        return sum;
    }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        float turn = u.x;
        int p = 0;
        for (; p < kPaths - 1 && turn >= m_share[p]; ++p) turn -= m_share[p];
        turn = m_share[p] > 0.0f ? std::clamp(turn / m_share[p], 0.0f, 0.99999994f) : 0.5f;
        const Vec2f w = split(u.y);
        const float v = m_variance[p];
        const float along =
            1.0f + v * std::log(std::max(w.x, 1e-5f) + (1.0f - w.x) * std::exp(-2.0f / v));
        const float sine = std::clamp(
            -along * m_tilted[p].x + cosine_of(along) * std::cos(2.0f * kPi * w.y) * m_tilted[p].y,
            -1.0f, 1.0f);
        const float phi =
            m_phi_o + (p < kPaths - 1 ? deflection(p) + m_azimuth.sample(turn) : 2.0f * kPi * turn);
        const float c = cosine_of(sine);
        wo = sine * m_x + c * (std::cos(phi) * m_y + std::sin(phi) * m_z);
        return true;
    }
    Vec3f albedo() const override { return m_albedo; }
    float peak() const override {
        return 1.0f / (2.0f * kPi * std::sqrt(2.0f * kPi * m_variance[1]));
    }

  private:
    using Densities = std::array<float, kPaths>;

    /// Cuticles scatter by what an artist can tell apart, not by the densities' own parameters.
    void set_roughness(const HairForm& form) {
        const auto bounded = [](float x) { return std::clamp(x, 0.001f, 1.0f); };
        const auto variance = [](float r) {
            const float root = 0.726f * r + 0.812f * r * r + 3.7f * std::pow(r, 20.0f);
            return root * root;
        };
        const float r = bounded(form.roughness), s = bounded(form.radial_roughness);
        const float v = variance(r);
        m_variance = {variance(bounded(form.first_roughness * r)), 0.25f * v, 4.0f * v, 4.0f * v};
        m_azimuth.scale =
            (0.265f * s + 1.194f * s * s + 5.372f * std::pow(s, 22.0f)) * std::sqrt(kPi / 8.0f);
    }
    void attenuate(float fresnel, const Vec3f& passed) {
        m_attenuation[0] = Vec3f(fresnel);
        m_attenuation[1] = (1.0f - fresnel) * (1.0f - fresnel) * passed;
        m_attenuation[2] = m_attenuation[1] * passed * fresnel;
        const Vec3f once = passed * fresnel;
        for (int c = 0; c < 3; ++c)
            m_attenuation[3][c] =
                once[c] < 1.0f ? m_attenuation[2][c] * once[c] / (1.0f - once[c]) : 0.0f;
        float total = 0.0f;
        for (int p = 0; p < kPaths; ++p) total += luminance(m_attenuation[p]);
        for (int p = 0; p < kPaths; ++p)
            m_share[p] = total > 0.0f ? luminance(m_attenuation[p]) / total : 0.25f;
    }
    /// Scales lean by `alpha`: each path leaves its cone by another multiple.
    void tilt(float alpha) {
        const std::array<float, kPaths> turns = {-2.0f, 1.0f, 4.0f, 0.0f};
        for (int p = 0; p < kPaths; ++p) {
            const float s = std::sin(turns[p] * alpha), c = std::cos(turns[p] * alpha);
            m_tilted[p] = {m_sin_o * c + m_cos_o * s, std::abs(m_cos_o * c - m_sin_o * s)};
        }
    }
    float deflection(int p) const {
        const auto n = static_cast<float>(p);
        return 2.0f * n * m_gamma_t - 2.0f * m_gamma_o + n * kPi;
    }
    Densities densities(const Vec3f& wo) const {
        const float sine = std::clamp(glm::dot(wo, m_x), -1.0f, 1.0f), cosine = cosine_of(sine);
        const float phi = std::atan2(glm::dot(wo, m_z), glm::dot(wo, m_y)) - m_phi_o;
        Densities d{};
        for (int p = 0; p < kPaths; ++p) {
            const float along =
                longitudinal(sine, cosine, m_tilted[p].x, m_tilted[p].y, m_variance[p]);
            const float around = p < kPaths - 1
                                     ? m_azimuth.density(angle_in_circle(phi - deflection(p)))
                                     : 0.5f * kInversePi;
            d[p] = along * around;
        }
        return d;
    }

    Vec3f m_x, m_y, m_z;
    float m_sin_o, m_cos_o, m_phi_o;  ///< of the view
    float m_gamma_o, m_gamma_t;       ///< where it enters, and inside
    std::array<float, kPaths> m_variance{}, m_share{};
    std::array<Vec3f, kPaths> m_attenuation{};
    std::array<Vec2f, kPaths> m_tilted{};  ///< sine and cosine of the view for each path
    TrimmedLogistic m_azimuth{};
    Vec3f m_albedo;
};

}  // namespace

std::unique_ptr<const LobeShape> make_principled_hair(const LobeView& view, const HairForm& form) {
    return std::make_unique<PrincipledHair>(view, form);
}

}  // namespace granita
