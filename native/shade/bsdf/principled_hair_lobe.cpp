// SPDX-License-Identifier: GPL-3.0-or-later
// Chiang, Bitterli, Tappan and Burley 2016, "A Practical and Controllable Hair and Fur Model for
// Production Path Tracing": light that is reflected (R), goes through (TT), is reflected inside
// (TRT), or more often, each a longitudinal times an azimuthal density.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "math/four_floats.h"
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

/// The logistic distribution cut to a full turn.
struct TrimmedLogistic {
    float scale = 1.0f;

    /// Share of the uncut distribution below x, |x| at most half a turn.
    float below(float x) const { return 1.0f / (1.0f + std::exp(std::min(-x / scale, 80.0f))); }
    /// 1 over the scale and what of the distribution the turn holds.
    float peak() const { return 1.0f / (scale * (1.0f - 2.0f * below(-kPi))); }
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

/// Fresnel's, exact, of a medium with the index `eta` > 1.
Floats reflectance(const Floats& cosine, float eta) {
    const Floats c = magnitude(cosine), g = root(eta * eta - 1.0f + c * c);
    return fresnel_of(c, g);
}

/// Light that meets the hair at four places of its width; of weight 0 beyond the last.
struct Crossings {
    Floats weight;
    std::array<Floats, kPaths - 1> deflections;
    /// Of each path red, green, blue and what samples take of it, times the weight.
    std::array<std::array<Floats, 4>, kPaths> parts;
};

/// Densities of inclinations about each path's cone, per cosine.
struct Longitudinal {
    Floats inverse;  ///< of the variance
    Floats scale;

    void set(const Floats& variance) {
        inverse = 1.0f / variance;
        scale = inverse / (1.0f - exponential(-2.0f * inverse));
    }
    /// exp(-b) I0(a) / (2 v sinh(1 / v)), a and b the products of cosines and of sines over v; the
    /// Bessel function within 5e-7 (Abramowitz and Stegun 9.8.1 and 9.8.2).
    Floats operator()(const Floats& sin_i, const Floats& cos_i, const Floats& sin_o,
                      const Floats& cos_o) const {
        const Floats cosines = cos_i * cos_o, sines = sin_i * sin_o, a = cosines * inverse;
        const Floats t = a / 3.75f, t2 = least(t * t, all(1.0f)), u = 1.0f / most(t, all(1.0f));
        Floats near = t2 * 0.0045813f + 0.0360768f;
        near = near * t2 + 0.2659732f;
        near = near * t2 + 1.2067492f;
        near = near * t2 + 3.0899424f;
        near = near * t2 + 3.5156229f;
        near = near * t2 + 1.0f;
        Floats far = u * 0.00392377f - 0.01647633f;
        far = far * u + 0.02635537f;
        far = far * u - 0.02057706f;
        far = far * u + 0.00916281f;
        far = far * u - 0.00157565f;
        far = far * u + 0.00225319f;
        far = far * u + 0.01328592f;
        far = far * u + 0.39894228f;
        const auto is_far = t > 1.0f;  // there e^a is taken out of the polynomial
        const Floats bessel = is_far ? far / root(most(a, all(1.0f))) : near;
        const Floats exponent = (is_far ? cosines : all(0.0f)) - sines - 1.0f;
        return exponential(exponent * inverse) * bessel * scale;
    }
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
            (form.tilts_light ? m_light_tilt : m_view_tilt).set(p, turn);
        }
        m_cones = m_view_tilt.back(m_sin_o, m_cos_o);
    }

    Vec3f evaluate(const Vec3f& wo) const override { return see(wo).light; }
    float pdf(const Vec3f& wo) const override { return see(wo).density; }
    bool sample(const Vec2f& u, Vec3f& wo) const override {
        float turn = u.x * m_width;
        const Crossings* four = m_crossings.data();
        std::size_t lane = 0;
        for (std::size_t k = 1; k < m_count && turn >= four->weight[lane]; ++k) {
            turn -= four->weight[lane];
            lane = k % 4;
            four += lane == 0 ? 1 : 0;
        }
        turn = std::min(turn, 0.99999994f * four->weight[lane]);
        std::size_t p = 0;
        for (; p < kPaths - 1 && turn >= four->parts[p][3][lane]; ++p)
            turn -= four->parts[p][3][lane];
        const float share = four->parts[p][3][lane];
        turn = share > 0.0f ? std::clamp(turn / share, 0.0f, 0.99999994f) : 0.5f;
        const Vec2f w = split(u.y);
        const float v = 1.0f / m_along.inverse[p];
        const float along =
            1.0f + v * std::log(std::max(w.x, 1e-5f) + (1.0f - w.x) * std::exp(-2.0f / v));
        const float on_cone =
            std::clamp(-along * m_cones.sine[p] +
                           cosine_of(along) * std::cos(2.0f * kPi * w.y) * m_cones.cosine[p],
                       -1.0f, 1.0f);
        const float sine =
            on_cone * m_light_tilt.cosine[p] + cosine_of(on_cone) * m_light_tilt.sine[p];
        const float around = p < kPaths - 1 ? four->deflections[p][lane] + m_azimuth.sample(turn)
                                            : 2.0f * kPi * turn;
        const float phi = m_phi_o + around, c = cosine_of(sine);
        wo = sine * m_x + c * (std::cos(phi) * m_y + std::sin(phi) * m_z);
        return true;
    }
    Vec3f albedo() const override { return m_albedo; }
    float mirrored_part(const Vec3f& wo) const override {
        const Seen& seen = see(wo);
        return seen.density > 0.0f ? seen.mirrored / seen.density : 1.0f;
    }
    float peak() const override {
        return std::sqrt(m_along.inverse[1] / (2.0f * kPi)) / (2.0f * kPi);
    }

  private:
    /// Angles of the paths.
    struct Angles {
        Floats cosine = all(1.0f), sine = all(0.0f);

        void set(std::size_t path, float angle) {
            cosine[path] = std::cos(angle);
            sine[path] = std::sin(angle);
        }
        /// An inclination, turned back by each.
        Angles back(float sin, float cos) const {
            return {magnitude(cos * cosine + sin * sine), sin * cosine - cos * sine};
        }
    };
    /// What is known of a direction.
    struct Seen {
        Vec3f wo{NAN}, light{0.0f};
        float density = 0.0f, mirrored = 0.0f;  ///< of all samples, of those that are mirrored
    };

    /// Cuticles scatter by what an artist can tell apart, not by the densities' own parameters.
    void set_roughness(const HairForm& form) {
        const auto bounded = [](float x) { return std::clamp(x, 0.001f, 1.0f); };
        const auto variance = [](float r) {
            const float root = 0.726f * r + 0.812f * r * r + 3.7f * std::pow(r, 20.0f);
            return root * root;
        };
        const float r = bounded(form.roughness), s = bounded(form.radial_roughness);
        const float v = variance(r), first = variance(bounded(form.first_roughness * r));
        m_along.set(Floats{first, 0.25f * v, 4.0f * v, 4.0f * v});
        m_azimuth.scale =
            (0.265f * s + 1.194f * s * s + 5.372f * std::pow(s, 22.0f)) * std::sqrt(kPi / 8.0f);
        m_peak = m_azimuth.peak();
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
        const float wanted = std::ceil(turn / spacing);
        const float count = wanted > 1.0f ? std::min(wanted, kMost) : 1.0f;
        const float step = (last - first) / count;
        m_count = static_cast<std::size_t>(count);
        m_crossings.resize((m_count + 3) / 4);
        Floats sine, cosine;
        for (int k = 0; k < 4; ++k) {
            const float gamma = first + (static_cast<float>(k) + 0.5f) * step;
            sine[k] = std::sin(gamma);
            cosine[k] = std::cos(gamma);
        }
        const float turn_sine = std::sin(4.0f * step), turn_cosine = std::cos(4.0f * step);
        Floats gamma = first + (Floats{0.5f, 1.5f, 2.5f, 3.5f}) * step, left = all(count);
        left -= Floats{0.5f, 1.5f, 2.5f, 3.5f};
        float reflected = 0.0f;
        for (Crossings& four : m_crossings) {
            four.weight = left > 0.0f ? most(cosine, all(1e-6f)) : all(0.0f);
            m_width += sum(four.weight);
            reflected += sum(four.weight * cross(form, gamma, sine, cosine, four));
            const Floats next = sine * turn_cosine + cosine * turn_sine;
            cosine = cosine * turn_cosine - sine * turn_sine;
            sine = next;
            gamma += 4.0f * step;
            left -= 4.0f;
        }
        m_albedo =
            glm::exp(-glm::sqrt(form.sigma) * hair_absorption_scale(4.0f / m_along.inverse[1])) +
            reflected / m_width;
    }
    /// At places that are turned by `gamma`, of a known weight.  Returns what is reflected.
    Floats cross(const HairForm& form, const Floats& gamma, const Floats& h, const Floats& cosine,
                 Crossings& four) {
        const float eta = std::max(form.ior, 1.0001f);
        const Floats sin_inside = most(
            least(h * (m_cos_o / std::sqrt(eta * eta - m_sin_o * m_sin_o)), all(1.0f)), all(-1.0f));
        const Floats inside = arc_sine(sin_inside);
        const Floats way =
            2.0f / cosine_of(m_sin_o / eta) * root(most(1.0f - sin_inside * sin_inside, all(0.0f)));
        for (std::size_t p = 0; p < kPaths - 1; ++p) {
            const auto n = static_cast<float>(p);
            four.deflections[p] = 2.0f * n * inside - 2.0f * gamma + n * kPi;
        }
        const Floats fresnel = reflectance(m_cos_o * cosine, eta), through = 1.0f - fresnel;
        for (std::size_t c = 0; c < 3; ++c) {
            const Floats passed = exponential(-form.sigma[static_cast<int>(c)] * way);
            const Floats once = passed * fresnel;
            four.parts[0][c] = fresnel;
            four.parts[1][c] = through * through * passed;
            four.parts[2][c] = four.parts[1][c] * once;
            four.parts[3][c] = once < 1.0f ? four.parts[2][c] * once / (1.0f - once) : all(0.0f);
        }
        Floats total = all(0.0f);
        for (auto& part : four.parts) {
            part[3] = luminance_of(part[0], part[1], part[2]);
            total += part[3];
        }
        for (auto& part : four.parts) {
            part[3] = total > 0.0f ? part[3] / total : all(0.25f);
            for (Floats& value : part) value *= four.weight;
        }
        return fresnel;
    }
    /// Density and light are asked for of the same direction in turn, and by one thread a point.
    const Seen& see(const Vec3f& wo) const {
        if (wo == m_seen.wo) return m_seen;
        const float sine = std::clamp(glm::dot(wo, m_x), -1.0f, 1.0f);
        const Angles light = m_light_tilt.back(sine, cosine_of(sine));
        const Floats along = m_along(light.sine, light.cosine, m_cones.sine, m_cones.cosine);
        const float phi = std::atan2(glm::dot(wo, m_z), glm::dot(wo, m_y)) - m_phi_o;
        std::array<std::array<Floats, 4>, kPaths> around{};
        for (const Crossings& four : m_crossings) {
            for (std::size_t p = 0; p < kPaths - 1; ++p) {
                Floats x = phi - four.deflections[p];
                x -= 2.0f * kPi * __builtin_convertvector(nearest(x * (0.5f * kInversePi)), Floats);
                const Floats e = exponential(-magnitude(x) / m_azimuth.scale), one = 1.0f + e;
                const Floats density = m_peak * e / (one * one);
                for (std::size_t c = 0; c < 4; ++c) around[p][c] += four.parts[p][c] * density;
            }
            for (std::size_t c = 0; c < 4; ++c)
                around[kPaths - 1][c] += four.parts[kPaths - 1][c] * (0.5f * kInversePi);
        }
        const auto of_path = [&](std::size_t p, std::size_t c) {
            return along[p] * sum(around[p][c]) / m_width;
        };
        m_seen = {wo};
        for (std::size_t p = 0; p < kPaths; ++p) {
            for (std::size_t c = 0; c < 3; ++c) m_seen.light[static_cast<int>(c)] += of_path(p, c);
            m_seen.density += of_path(p, 3);
        }
        m_seen.mirrored = of_path(0, 3);
        return m_seen;
    }

    Vec3f m_x, m_y, m_z;
    float m_sin_o, m_cos_o, m_phi_o;  ///< of the view
    Longitudinal m_along{};
    // Of the scales: by how much they turn the view's inclination, or the light's.
    Angles m_view_tilt, m_light_tilt;
    Angles m_cones;  ///< the view's inclination, turned
    TrimmedLogistic m_azimuth;
    float m_peak = 0.0f;  ///< m_azimuth's
    std::size_t m_count = 0;
    std::vector<Crossings> m_crossings;
    float m_width = 0.0f;  ///< sum of their weights
    Vec3f m_albedo{0.0f};
    mutable Seen m_seen;
};

}  // namespace

std::unique_ptr<const LobeShape> make_principled_hair(const LobeView& view, const HairForm& form) {
    return std::make_unique<PrincipledHair>(view, form);
}

}  // namespace granita
