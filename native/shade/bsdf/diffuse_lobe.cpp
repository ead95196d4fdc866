// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/microfacet.h"

namespace granita {
namespace {

/// Integral of Fujii's improved Oren-Nayar model over one direction, less the Lambert part
/// (mimosa-pudica.net/improved-oren-nayar.html).
float oren_nayar_g(float cos_theta) {
    if (cos_theta < 1e-6f) return 0.5f * kPi - 2.0f / 3.0f - cos_theta;  // Taylor: tan overflows
    const float sin_theta = std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta));
    const float theta = std::acos(std::min(cos_theta, 1.0f));
    return sin_theta * (theta - 2.0f / 3.0f - sin_theta * cos_theta) +
           2.0f / 3.0f * (sin_theta / cos_theta) * (1.0f - sin_theta * sin_theta * sin_theta);
}

/// Burley 2012, with the retro-reflection of 2015: relative to Lambert.
float burley_factor(float roughness, bool retro_alone, float cos_wi_wo, float cos_i, float cos_o) {
    const float fi = schlick_weight(cos_i), fo = schlick_weight(cos_o);
    const float retro = roughness * (cos_wi_wo + 1.0f);
    const float plain = retro_alone ? 0.0f : (1.0f - 0.5f * fi) * (1.0f - 0.5f * fo);
    return plain + retro * (fo + fi + fo * fi * (retro - 1.0f));
}

/// Fades light that grazes a bumped surface (Conty Estevez, Lecocq and Stein 2019).
float bump_shadowing(const Vec3f& surface_normal, const Vec3f& normal, const Vec3f& wo) {
    const float cos_o = glm::dot(surface_normal, wo), cos_d = glm::dot(surface_normal, normal);
    if (cos_o * cos_d * glm::dot(normal, wo) < 0.0f) return 0.0f;
    const float abs_o = std::abs(cos_o), abs_d = std::abs(cos_d);
    if (abs_d >= 1.0f || abs_o >= 1.0f) return 1.0f;
    if (abs_o < 1e-6f) return 0.0f;
    const float tan2 = 1.0f / (abs_d * abs_d) - 1.0f;
    const float alpha2 = std::clamp(0.125f * tan2, 0.0f, 1.0f);
    return 1.0f / (1.0f + ggx_lambda(std::sqrt(alpha2), abs_o));
}

/// The same before Blender 4.5: a smooth step over the cosines' ratio (Chiang, Li and Burley 2019).
float cosine_bump_shadowing(const Vec3f& surface_normal, const Vec3f& normal, const Vec3f& wo) {
    const float bent = glm::dot(surface_normal, normal) * glm::dot(normal, wo);
    const float g = bent != 0.0f ? glm::dot(surface_normal, wo) / bent : 0.0f;
    if (g >= 1.0f) return 1.0f;
    return g > 0.0f ? ((1.0f - g) * g + 1.0f) * g : 0.0f;
}

}  // namespace

void PointBsdf::prepare_diffuse(Prepared& lobe, const Lobe& source, std::size_t point) const {
    const float roughness = source.roughness.empty() ? 0.0f : source.roughness[point];
    const float sigma = std::clamp(roughness, 0.0f, 1.0f);
    if (sigma < 1e-5f) return;
    lobe.oren_a = 1.0f / (kPi + sigma * (0.5f * kPi - 2.0f / 3.0f));
    lobe.oren_b = sigma * lobe.oren_a;
    if (source.f0.empty()) return;
    // Energy-preserving multiple scattering of the OpenPBR specification.
    const Vec3f albedo = glm::clamp(source.f0[point], Vec3f(0.0f), Vec3f(1.0f));
    const float mean = lobe.oren_a * kPi + (2.0f * kPi - 5.6f) / 3.0f * lobe.oren_b;
    const float seen = lobe.oren_a * kPi + lobe.oren_b * oren_nayar_g(std::max(lobe.cos_wi, 0.0f));
    const Vec3f taken = source.deepens_color ? albedo * albedo : albedo;
    lobe.oren_multiscatter = kInversePi * taken * (mean / (1.0f - mean)) /
                             (Vec3f(1.0f) - albedo * (1.0f - mean)) * (1.0f - seen);
}

Vec3f PointBsdf::evaluate_diffuse(const Prepared& lobe, const Vec3f& wo) const {
    const float cos_o = glm::dot(lobe.normal, wo);
    if (cos_o <= 0.0f) return Vec3f(0.0f);
    Vec3f value(cos_o * kInversePi);
    if (lobe.burley >= 0.0f) {
        value *=
            burley_factor(lobe.burley, lobe.retro_alone, glm::dot(wo, m_wi), lobe.cos_wi, cos_o);
    } else if (lobe.oren_b > 0.0f) {
        const float cos_i = std::max(lobe.cos_wi, 0.0f);
        float t = glm::dot(wo, m_wi) - cos_o * cos_i;
        if (t > 0.0f) t /= std::max(cos_o, cos_i);
        const float lost =
            1.0f - (lobe.oren_a * kPi + lobe.oren_b * oren_nayar_g(std::min(cos_o, 1.0f)));
        value = cos_o * (Vec3f(lobe.oren_a + lobe.oren_b * t) + lobe.oren_multiscatter * lost);
    }
    return lobe.weight * value * unshadowed(lobe, wo, false);
}

float PointBsdf::unshadowed(const Prepared& lobe, const Vec3f& wo, bool is_drawn) const {
    if (lobe.normal == m_normal) return 1.0f;
    const bool transmits = granita::transmits(lobe.kind);
    // Through the surface goes only what transmits.
    if ((glm::dot(m_normal, wo) < 0.0f) != transmits) return 0.0f;
    // Cycles fades what lamps send through it, and nothing that it meets by chance.
    if (is_drawn && transmits) return 1.0f;
    return lobe.cosine_bumps ? cosine_bump_shadowing(m_normal, lobe.normal, wo)
                             : bump_shadowing(m_normal, lobe.normal, wo);
}

}  // namespace granita
