// SPDX-License-Identifier: GPL-3.0-or-later
// Chiang, Bitterli, Tappan and Burley 2016, "A Practical and Controllable Hair and Fur Model for
// Production Path Tracing": light that is reflected (R), goes through (TT), is reflected inside
// (TRT), or more often, each a longitudinal times an azimuthal density.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/hair_color.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

constexpr std::size_t kPaths = 4;

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

/// Light that meets the hair at one place of its width.
struct Crossing {
    float weight;  ///< of the width that the point stands for
    std::array<float, kPaths - 1> deflections;
    std::array<Vec3f, kPaths> attenuation;
    std::array<float, kPaths> shares;  ///< of samples
};

class PrincipledHair : public LobeShape {
  public:
    PrincipledHair(const LobeView& view, const HairForm& form) : m_x(form.tangent) {
        const Vec3f y = glm::cross(m_x, view.wi);
        const float length = glm::length(y);
        m_y = length > 1e-6f ? y / length : Basis(m_x).x;
        m_z = glm::cross(m_x, m_y);
        set_roughness(form);
        m_sin_o = std::clamp(glm::dot(view.wi, m_x), -1.0f, 1.0f);
        m_cos_o = cosine_of(m_sin_o);
        m_phi_o = std::atan2(glm::dot(view.wi, m_z), glm::dot(view.wi, m_y));
        // Where across the hair the view meets it: the sine of the tube's normal.
        const float h = std::clamp(glm::dot(glm::cross(view.normal, m_x), m_z), -1.0f, 1.0f);
        cross(form, h);
        for (std::size_t p = 0; p < kPaths; ++p) {
            // Scales lean: each path leaves its cone by another multiple.
            const float turn = std::array{-2.0f, 1.0f, 4.0f, 0.0f}[p] * form.offset;
            (form.tilts_light ? m_light_tilt : m_view_tilt)[p] = {std::cos(turn), std::sin(turn)};
            m_cones[p] = tilted({m_cos_o, m_sin_o}, m_view_tilt[p], -1.0f);
        }
    }

    Vec3f evaluate(const Vec3f& wo) const override {
        return sum_of<Vec3f>(wo, &Crossing::attenuation);
    }
    float pdf(const Vec3f& wo) const override { return sum_of<float>(wo, &Crossing::shares); }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        float turn = u.x;
        const Crossing* crossing = m_crossings.data();
        while (crossing != &m_crossings.back() && turn >= crossing->weight)
            turn -= (crossing++)->weight;
        turn = std::clamp(turn / crossing->weight, 0.0f, 0.99999994f);
        const auto& shares = crossing->shares;
        std::size_t p = 0;
        for (; p < kPaths - 1 && turn >= shares[p]; ++p) turn -= shares[p];
        turn = shares[p] > 0.0f ? std::clamp(turn / shares[p], 0.0f, 0.99999994f) : 0.5f;
        const Vec2f w = split(u.y);
        const float v = m_variance[p];
        const float along =
            1.0f + v * std::log(std::max(w.x, 1e-5f) + (1.0f - w.x) * std::exp(-2.0f / v));
        const float on_cone = std::clamp(
            -along * m_cones[p].y + cosine_of(along) * std::cos(2.0f * kPi * w.y) * m_cones[p].x,
            -1.0f, 1.0f);
        const float sine = tilted({cosine_of(on_cone), on_cone}, m_light_tilt[p], 1.0f).y;
        const float around =
            p < kPaths - 1 ? crossing->deflections[p] + m_azimuth.sample(turn) : 2.0f * kPi * turn;
        const float phi = m_phi_o + around, c = cosine_of(sine);
        wo = sine * m_x + c * (std::cos(phi) * m_y + std::sin(phi) * m_z);
        return true;
    }
    Vec3f albedo() const override { return m_albedo; }
    float mirrored_part(const Vec3f& wo) const override {
        const float all = pdf(wo);
        return all > 0.0f ? sum_of<float>(wo, &Crossing::shares, 1) / all : 1.0f;
    }
    float peak() const override {
        return 1.0f / (2.0f * kPi * std::sqrt(2.0f * kPi * m_variance[1]));
    }

  private:
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
    /// Azimuth turns by up to a full circle across the hair: what a point stands for is met at
    /// evenly turned places, closer than the azimuthal densities are wide.
    void cross(const HairForm& form, float h) {
        float first = std::asin(h), last = first;
        if (form.cells >= 1.0f) {
            const float middle = std::copysign(form.aside, h), half = 1.0f / form.cells;
            first = std::asin(std::max(middle - half, -1.0f));
            last = std::asin(std::min(middle + half, 1.0f));
        }
        constexpr float kSpacing = 2.0f;  // of the densities' scale
        constexpr float kMost = 64.0f;
        // What is reflected and absorbed varies over a hair that is ever so rough.
        constexpr float kWidest = 0.6f;
        const float turn = 2.0f * (last - first);
        const float spacing = std::min(kSpacing * m_azimuth.scale, kWidest);
        const float count = std::clamp(std::ceil(turn / spacing), 1.0f, kMost);
        const float step = (last - first) / count;
        float sum = 0.0f, reflected = 0.0f;
        for (float k = 0.5f; k < count; k += 1.0f) {
            const float gamma = first + k * step, weight = std::cos(gamma);
            sum += weight;
            reflected += weight * add_crossing(form, gamma, weight);
        }
        for (Crossing& crossing : m_crossings) crossing.weight /= sum;
        m_albedo = glm::exp(-glm::sqrt(form.sigma) * hair_absorption_scale(4.0f * m_variance[1])) +
                   reflected / sum;
    }
    /// Returns what is reflected.
    float add_crossing(const HairForm& form, float gamma, float weight) {
        const float h = std::sin(gamma), eta = std::max(form.ior, 1.0001f);
        const float sin_inside = h * m_cos_o / std::sqrt(eta * eta - m_sin_o * m_sin_o);
        const float inside = std::asin(std::clamp(sin_inside, -1.0f, 1.0f));
        const float way = 2.0f * cosine_of(sin_inside) / cosine_of(m_sin_o / eta);
        const float reflected = fresnel_dielectric(m_cos_o * cosine_of(h), eta);
        Crossing& crossing = m_crossings.emplace_back();
        crossing.weight = weight;
        for (std::size_t p = 0; p < kPaths - 1; ++p) {
            const auto n = static_cast<float>(p);
            crossing.deflections[p] = 2.0f * n * inside - 2.0f * gamma + n * kPi;
        }
        attenuate(reflected, glm::exp(-form.sigma * way), crossing);
        return reflected;
    }
    static void attenuate(float fresnel, const Vec3f& passed, Crossing& crossing) {
        auto& attenuation = crossing.attenuation;
        attenuation[0] = Vec3f(fresnel);
        attenuation[1] = (1.0f - fresnel) * (1.0f - fresnel) * passed;
        attenuation[2] = attenuation[1] * passed * fresnel;
        const Vec3f once = passed * fresnel;
        for (int c = 0; c < 3; ++c)
            attenuation[3][c] =
                once[c] < 1.0f ? attenuation[2][c] * once[c] / (1.0f - once[c]) : 0.0f;
        float total = 0.0f;
        for (const Vec3f& part : attenuation) total += luminance(part);
        for (std::size_t p = 0; p < kPaths; ++p)
            crossing.shares[p] = total > 0.0f ? luminance(attenuation[p]) / total : 0.25f;
    }
    static std::array<Vec2f, kPaths> no_turns() {
        std::array<Vec2f, kPaths> none;
        none.fill({1.0f, 0.0f});
        return none;
    }
    /// Cosine and sine of an inclination, turned on by an angle or, `sign` -1, back by it.
    static Vec2f tilted(const Vec2f& inclination, const Vec2f& angle, float sign) {
        const float s = sign * angle.y;
        return {std::abs(inclination.x * angle.x - inclination.y * s),
                inclination.y * angle.x + inclination.x * s};
    }
    /// Densities of the first `count` ways through the hair, by `factors` of these.
    template <class T>
    T sum_of(const Vec3f& wo, std::array<T, kPaths> Crossing::*factors,
             std::size_t count = kPaths) const {
        const float sine = std::clamp(glm::dot(wo, m_x), -1.0f, 1.0f), cosine = cosine_of(sine);
        const float phi = std::atan2(glm::dot(wo, m_z), glm::dot(wo, m_y)) - m_phi_o;
        std::array<T, kPaths> around{};
        for (const Crossing& crossing : m_crossings) {
            const std::array<T, kPaths>& factor = crossing.*factors;
            for (std::size_t p = 0; p < kPaths - 1; ++p)
                around[p] +=
                    factor[p] * (crossing.weight *
                                 m_azimuth.density(angle_in_circle(phi - crossing.deflections[p])));
            around[kPaths - 1] += factor[kPaths - 1] * (crossing.weight * 0.5f * kInversePi);
        }
        T sum(0.0f);
        for (std::size_t p = 0; p < count; ++p) {
            const Vec2f light = tilted({cosine, sine}, m_light_tilt[p], -1.0f);
            sum += around[p] *
                   longitudinal(light.y, light.x, m_cones[p].y, m_cones[p].x, m_variance[p]);
        }
        return sum;
    }

    Vec3f m_x, m_y, m_z;
    float m_sin_o, m_cos_o, m_phi_o;  ///< of the view
    std::array<float, kPaths> m_variance{};
    // Cosines and sines, for each path: of the scales' turn of the view or the light, and of the
    // view's inclination with it.
    std::array<Vec2f, kPaths> m_view_tilt = no_turns(), m_light_tilt = no_turns(), m_cones{};
    TrimmedLogistic m_azimuth{};
    std::vector<Crossing> m_crossings;
    Vec3f m_albedo{0.0f};
};

}  // namespace

std::unique_ptr<const LobeShape> make_principled_hair(const LobeView& view, const HairForm& form) {
    return std::make_unique<PrincipledHair>(view, form);
}

}  // namespace granita
