// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/microfacet.h"

namespace granita {
namespace {

/// Below this alpha the lobe is narrower than a pixel of any usual frame (0.2 mrad reflected) and
/// is treated as a mirror.
constexpr float kSharpAlpha = 1e-4f;

Vec3f mix(const Vec3f& a, const Vec3f& b, float t) {
    return a + (b - a) * t;
}

/// Where x lies from a (0) to b (1), clamped.
float fraction_between(float a, float b, float x) {
    return b == a ? 0.0f : std::clamp((x - a) / (b - a), 0.0f, 1.0f);
}

/// Cosine-weighted mean of fresnel_dielectric, fit of Kulla and Conty 2017.
float dielectric_mean(float ior) {
    if (ior < 1.0f) return 0.997118f + ior * (0.1014f - ior * (0.965241f + ior * 0.130607f));
    return (ior - 1.0f) / (4.08567f + 1.00071f * ior);
}

}  // namespace

void PointBsdf::prepare_microfacets(Prepared& lobe, float roughness) const {
    const float clamped = std::clamp(roughness, 0.0f, 1.0f);
    lobe.alpha = clamped * clamped;
    lobe.sharp = lobe.distribution == Distribution::Sharp || lobe.alpha <= kSharpAlpha;
    lobe.f0_real = f0_from_ior(lobe.ior);
    if (lobe.fresnel == FresnelKind::F82Tint) lobe.dip = f82_dip(lobe.f0, lobe.f90);
}

void PointBsdf::compensate(Prepared& lobe, float roughness, const GgxAlbedo& albedo) const {
    if (lobe.sharp) return;
    const float clamped = std::clamp(roughness, 0.0f, 1.0f);
    // Kulla and Conty 2017: scale by 1 / E, then darken by what Fresnel takes at each extra bounce.
    const float e = albedo.directional(clamped, lobe.cos_wi);
    const float e_mean = albedo.average(clamped);
    const float missing = (1.0f - e) / e;
    lobe.directional_albedo = e;
    Vec3f fss = lobe.f0;
    if (lobe.fresnel == FresnelKind::Schlick) fss = mix(lobe.f0, lobe.f90, 1.0f / 21.0f);
    if (lobe.fresnel == FresnelKind::F82Tint) fss = f82_mean(lobe.f0, lobe.dip);
    if (lobe.fresnel == FresnelKind::Dielectric)
        fss =
            mix(lobe.f0, lobe.f90, fraction_between(lobe.f0_real, 1.0f, dielectric_mean(lobe.ior)));
    const Vec3f fms = fss * e_mean / (Vec3f(1.0f) - fss * (1.0f - e_mean));
    lobe.weight *= Vec3f(1.0f) + fms * missing;
}

Vec3f PointBsdf::fresnel(const Prepared& lobe, float cos_half) const {
    switch (lobe.fresnel) {
        case FresnelKind::Schlick:
            return mix(lobe.f0, lobe.f90, schlick_weight(cos_half));
        case FresnelKind::F82Tint:
            return fresnel_f82(lobe.f0, lobe.dip, cos_half);
        case FresnelKind::Dielectric:
            return mix(
                lobe.f0, lobe.f90,
                fraction_between(lobe.f0_real, 1.0f, fresnel_dielectric(cos_half, lobe.ior)));
        case FresnelKind::None:
            break;
    }
    return Vec3f(1.0f);
}

Vec3f PointBsdf::evaluate_glossy(const Prepared& lobe, const Vec3f& wo) const {
    const float cos_o = glm::dot(lobe.normal, wo);
    if (cos_o <= 0.0f || glm::dot(m_geometric_normal, wo) < 0.0f) return Vec3f(0.0f);
    const Vec3f half = glm::normalize(m_wi + wo);
    const float d = density_of(lobe.distribution, lobe.alpha, squared_sine(lobe.normal, half));
    const float lambda_i = lambda_of(lobe.distribution, lobe.alpha, lobe.cos_wi);
    const float lambda_o = lambda_of(lobe.distribution, lobe.alpha, cos_o);
    const float masking =
        lobe.separable_masking ? (1.0f + lambda_i) * (1.0f + lambda_o) : 1.0f + lambda_i + lambda_o;
    return lobe.weight * fresnel(lobe, glm::dot(half, m_wi)) *
           (0.25f * d / (lobe.cos_wi * masking));
}

float PointBsdf::pdf_glossy(const Prepared& lobe, const Vec3f& wo) const {
    const Vec3f half = glm::normalize(m_wi + wo);
    const float d = density_of(lobe.distribution, lobe.alpha, squared_sine(lobe.normal, half));
    if (lobe.distribution != Distribution::Ggx)  // D cos(h) is sampled, not what is visible of it
        return 0.25f * d * glm::dot(lobe.normal, half) / std::max(glm::dot(half, m_wi), 1e-9f);
    return 0.25f * d / (lobe.cos_wi * (1.0f + ggx_lambda(lobe.alpha, lobe.cos_wi)));
}

}  // namespace granita
