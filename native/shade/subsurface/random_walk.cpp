// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/subsurface/random_walk.h"

#include <limits>

namespace granita {
namespace {

/// A way that goes on so long brings next to nothing.
constexpr int kMostScatterings = 1024;
/// Scatterings after which nobody sees where light went at first: ways go on in a medium without a
/// preferred direction, in larger steps, as in Cycles.
constexpr int kAlike = 9;
/// Weight, of that at the start, below which ways end by Russian roulette.
constexpr float kRoulette = 0.05f;
/// Mean free paths within which the far side is looked for.
constexpr float kFarSide = 10.0f;

class Numbers {
  public:
    explicit Numbers(std::uint64_t seed) : m_state(seed) {}
    /// In [0, 1).
    float next() {
        m_state += 0x9e3779b97f4a7c15ULL;
        return unit_float(mix_bits(m_state));
    }

  private:
    std::uint64_t m_state;
};

/// Directions and distances that lead out of a half-space as light itself finds its way: Dwivedi's,
/// after Krivanek and d'Eon 2014 ("A Zero-variance-based Sampling Scheme for Monte Carlo Subsurface
/// Scattering") and Meng, Hanika and Dachsbacher 2016 ("Improving the Dwivedi Sampling Scheme").
class Guide {
  public:
    /// d'Eon and Krivanek 2020 ("Zero-Variance Theory for Efficient Subsurface Scattering", eq.
    /// 67), where it neither ends nor goes on forever.
    explicit Guide(float albedo) {
        const float a = std::clamp(albedo, 0.2f, 0.9999f);
        m_length = 1.0f / std::sqrt(1.0f - std::pow(a, 2.44294f - 0.0215813f * a + 0.578637f / a));
        m_log = std::log((m_length + 1.0f) / (m_length - 1.0f));
    }
    /// Of the angle to the way out.
    float sample_cosine(float u) const {
        return std::clamp(m_length - (m_length + 1.0f) * std::exp(-u * m_log), -1.0f, 1.0f);
    }
    /// Per solid angle.
    float density(float cosine) const { return 0.5f * kInversePi / ((m_length - cosine) * m_log); }
    /// By which extinction seems less on the way out, and more against it.
    float stretch(float cosine) const { return 1.0f - cosine / m_length; }
    /// In mean free paths.
    float diffusion_length() const { return m_length; }

  private:
    float m_length, m_log;
};

/// How ways are led out of a medium.
struct Lead {
    explicit Lead(const ScatteringMedium& medium)
        : guide(largest(medium.albedo)),
          share(1.0f - std::max(0.5f, std::pow(std::abs(medium.g), 0.125f))),
          thinnest(std::min({medium.extinction.x, medium.extinction.y, medium.extinction.z})) {}
    Guide guide;
    float share;     ///< of directions that the guide draws
    float thinnest;  ///< least extinction
};

/// Henyey and Greenstein 1941, per solid angle.
float phase(float g, float cosine) {
    const float d = 1.0f + g * g - 2.0f * g * cosine;
    return 0.25f * kInversePi * (1.0f - g * g) / (d * std::sqrt(d));
}

float sample_phase(float g, float u) {
    if (std::abs(g) < 1e-3f) return 1.0f - 2.0f * u;
    const float ratio = (1.0f - g * g) / (1.0f - g + 2.0f * g * u);
    return std::clamp((1.0f + g * g - ratio * ratio) / (2.0f * g), -1.0f, 1.0f);
}

Vec3f turned(const Vec3f& axis, float cosine, float u) {
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), phi = 2.0f * kPi * u;
    return Basis(axis).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
}

/// Of reaching `t`, or of a collision there, by channel.
Vec3f arrival(const Vec3f& extinction, float t, bool reached) {
    const Vec3f left = glm::exp(-extinction * t);
    return reached ? left : extinction * left;
}

/// What ways meet of a body.  Places are from the start of a way, so that those much shorter than
/// rounding of its position (skin of a person, in metres from the camera) are told apart.
class Inside {
  public:
    Inside(const RayScene& rays, const RayScene::Body& body, const WalkStart& start)
        : m_rays(rays), m_body(body), m_start(start) {}

    /// As RayScene::nearest.  The surface is a plane where numbers do not tell it from a place:
    /// rays begin so deep that they do, and what lies between is found without.  Begun that deep,
    /// ways of a twelfth of it brought back .6 of the light.
    bool meets(const Vec3f& place, const Vec3f& direction, float far, RayScene::Met& met) const {
        const float height = glm::dot(place, m_start.normal);
        Vec3f from = place;
        if (std::abs(height) < m_start.rounding) {
            if (const float rise = glm::dot(direction, m_start.normal); rise > 0.0f) {
                const float t = std::max(-height, 0.0f) / rise;
                if (t >= far) return false;
                if (is_surface(place + t * direction, met)) {
                    met.hit.direction = direction;
                    met.hit.distance = t;
                    return true;
                }
            }
            from -= (height + m_start.rounding) * m_start.normal;
        }
        return m_rays.nearest(m_body, {m_start.p + from, direction, far, m_body.time}, met);
    }

  private:
    /// Not beyond an edge.
    bool is_surface(const Vec3f& place, RayScene::Met& met) const {
        const Vec3f above = m_start.p + place + m_start.rounding * m_start.normal;
        return m_rays.nearest(m_body,
                              {above, -m_start.normal, 2.0f * m_start.rounding, m_body.time}, met);
    }

    const RayScene& m_rays;
    const RayScene::Body& m_body;
    const WalkStart& m_start;
};

}  // namespace

bool walk(const RayScene& rays, const RayScene::Body& body, ScatteringMedium medium,
          const WalkStart& start, Vec3f& weight, RayScene::Met& exit) {
    Numbers numbers(start.seed);
    Lead lead(medium);
    const Vec3f& sigma = medium.extinction;
    const float least = kRoulette * largest(weight);
    const Inside inside(rays, body, start);
    Vec3f place(0.0f), direction = start.direction;
    float far_side = 0.0f;  // its depth; 0: there is none
    for (int scattering = 0; scattering < kMostScatterings; ++scattering) {
        if (scattering == kAlike && medium.g != 0.0f) {
            medium = medium.isotropic();
            lead = Lead(medium);
        }
        // A channel by what it still brings; all that could have led here share what it did
        // (Wilkie et al. 2014, "Hero Wavelength Spectral Sampling").
        Vec3f share = weight * medium.albedo;
        const float sum = share.x + share.y + share.z;
        if (!(sum > 0.0f)) return false;
        share /= sum;
        const float pick = numbers.next();
        const int channel = pick < share.x ? 0 : pick < share.x + share.y ? 1 : 2;
        float stretched = sigma[channel];
        const bool is_first = scattering == 0;
        float forward = 1.0f, backward = 1.0f, out = 1.0f, in = 1.0f, back = 0.0f;
        if (!is_first) {
            const bool guided = numbers.next() < lead.share;
            if (far_side > 0.0f) {
                const float depth = std::clamp(-glm::dot(place, start.normal), 0.0f, far_side);
                back = 1.0f / (1.0f + std::exp((far_side - 2.0f * depth) * lead.thinnest /
                                               lead.guide.diffusion_length()));
            }
            const bool turns_back = numbers.next() < back;
            const float u = numbers.next(), v = numbers.next();
            const Vec3f before = direction;
            float cosine;
            if (guided) {
                cosine = (turns_back ? -1.0f : 1.0f) * lead.guide.sample_cosine(u);
                direction = turned(start.normal, cosine, v);
            } else {
                direction = turned(before, sample_phase(medium.g, u), v);
                cosine = glm::dot(direction, start.normal);
            }
            const float scattered = phase(medium.g, glm::dot(before, direction));
            forward = lead.guide.density(cosine) / scattered;
            backward = lead.guide.density(-cosine) / scattered;
            out = lead.guide.stretch(cosine);
            in = lead.guide.stretch(-cosine);
            if (guided) stretched *= turns_back ? in : out;
        }
        float t = -std::log(1.0f - numbers.next()) / stretched;
        const float look = is_first ? std::max(t, kFarSide / lead.thinnest) : t;
        bool leaves = inside.meets(place, direction, look, exit);
        if (leaves && is_first) {
            far_side = std::max(-glm::dot(start.normal, direction) * exit.hit.distance, 0.0f);
            leaves = exit.hit.distance < t;
        }
        if (leaves) t = exit.hit.distance;
        place += t * direction;
        const Vec3f plain = arrival(sigma, t, leaves);
        Vec3f density = plain;
        if (!is_first) {
            Vec3f guided = forward * arrival(out * sigma, t, leaves);
            if (far_side > 0.0f)
                guided = glm::mix(guided, backward * arrival(in * sigma, t, leaves), back);
            density = glm::mix(plain, guided, lead.share);
        }
        const float all = glm::dot(share, density);
        if (!(all > 0.0f)) return false;
        weight *= (leaves ? plain : medium.albedo * plain) / all;
        if (leaves) return is_finite(weight);
        if (const float left = largest(weight); left < least) {
            if (!(numbers.next() * least < left)) return false;
            weight *= least / left;
        }
    }
    return false;
}

}  // namespace granita
