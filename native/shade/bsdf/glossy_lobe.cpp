// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/fresnel_albedo.h"
#include "shade/bsdf/microfacet.h"

namespace granita {
namespace {

/// Of stretched facets along their smoother axis: densities stay numbers.
constexpr float kLeastAlpha = 1e-5f;

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

void PointBsdf::compensate(Prepared& lobe, float made, const GgxAlbedo& albedo) const {
    if (lobe.sharp) return;
    const float roughness = std::sqrt(lobe.alpha);
    lobe.directional_albedo = albedo.directional(roughness, lobe.cos_wi);
    // Kulla and Conty 2017: scale by 1 / E, then darken by what Fresnel takes at each extra bounce.
    const float e =
        made == roughness ? lobe.directional_albedo : albedo.directional(made, lobe.cos_wi);
    const float e_mean = albedo.average(made);
    const float missing = (1.0f - e) / e;
    Vec3f fss = lobe.f0;
    if (lobe.fresnel == FresnelKind::Schlick) fss = mix(lobe.f0, lobe.f90, 1.0f / 21.0f);
    if (lobe.fresnel == FresnelKind::F82Tint) fss = f82_mean(lobe.f0, lobe.dip);
    if (lobe.fresnel == FresnelKind::Conductor) fss = conductor_mean(lobe.f0, lobe.f90);
    if (lobe.fresnel == FresnelKind::Dielectric)
        fss =
            mix(lobe.f0, lobe.f90, fraction_between(lobe.f0_real, 1.0f, dielectric_mean(lobe.ior)));
    const Vec3f fms = fss * e_mean / (Vec3f(1.0f) - fss * (1.0f - e_mean));
    lobe.weight *= Vec3f(1.0f) + fms * missing;
}

Vec3f PointBsdf::film_fresnel(const Prepared& lobe, float cos_half) const {
    if (lobe.fresnel == FresnelKind::Conductor)
        return film_on_conductor(lobe.film, cos_half, lobe.f0, lobe.f90);
    if (lobe.fresnel == FresnelKind::F82Tint)
        return film_on_metal(lobe.film, cos_half, lobe.f0, lobe.dip);
    return film_on_dielectric(lobe.film, cos_half, lobe.ior, lobe.f0);
}

Vec3f PointBsdf::fresnel(const Prepared& lobe, float cos_half) const {
    if (lobe.film.is_there()) return film_fresnel(lobe, cos_half);
    switch (lobe.fresnel) {
        case FresnelKind::Schlick:
            return mix(lobe.f0, lobe.f90, schlick_weight(cos_half));
        case FresnelKind::F82Tint:
            return fresnel_f82(lobe.f0, lobe.dip, cos_half);
        case FresnelKind::Conductor:
            return fresnel_conductor(cos_half, lobe.f0, lobe.f90);
        case FresnelKind::Dielectric:
            return mix(
                lobe.f0, lobe.f90,
                fraction_between(lobe.f0_real, 1.0f, fresnel_dielectric(cos_half, lobe.ior)));
        case FresnelKind::None:
            break;
    }
    return Vec3f(1.0f);
}

Vec3f PointBsdf::seen_part(const Prepared& lobe) const {
    // The mean over the facets that the view sees; that by the normal alone of films, conductors
    // and what is refracted, as in Cycles.
    const float roughness = std::sqrt(lobe.alpha);
    if (lobe.kind == LobeKind::Glossy && !lobe.smooth_color && !lobe.film.is_there()) {
        if (lobe.fresnel == FresnelKind::Dielectric)
            return mix(lobe.f0, lobe.f90, dielectric_share(roughness, lobe.cos_wi, lobe.ior));
        if (lobe.fresnel == FresnelKind::Schlick)
            return mix(lobe.f0, lobe.f90, schlick_share(roughness, lobe.cos_wi));
        if (lobe.fresnel == FresnelKind::F82Tint)
            return mix(lobe.f0, Vec3f(1.0f), schlick_share(roughness, lobe.cos_wi));
    }
    return passed(lobe, lobe.cos_wi);
}

void PointBsdf::stretch(Prepared& lobe, const Vec3f& tangent, float aspect) const {
    const Vec3f y = glm::cross(lobe.normal, tangent);
    const float length = glm::length(y);
    lobe.alphas = glm::clamp(Vec2f(lobe.alpha / aspect, lobe.alpha * aspect), Vec2f(kLeastAlpha),
                             Vec2f(1.0f));
    if (!(length > 0.0f) || lobe.alphas.x == lobe.alphas.y) return;
    lobe.stretched = true;
    lobe.x = glm::cross(y / length, lobe.normal);
    lobe.alpha = std::sqrt(lobe.alphas.x * lobe.alphas.y);
    lobe.sharp = lobe.distribution == Distribution::Sharp || lobe.alpha <= kSharpAlpha;
}

Vec3f PointBsdf::local(const Prepared& lobe, const Vec3f& v) const {
    return {glm::dot(v, lobe.x), glm::dot(v, glm::cross(lobe.normal, lobe.x)),
            glm::dot(v, lobe.normal)};
}

PointBsdf::MirroringFacets PointBsdf::mirroring_facets(const Prepared& lobe,
                                                       const Vec3f& wo) const {
    const Vec3f half = glm::normalize(m_wi + wo);
    if (lobe.stretched)
        return {half, stretched_density(lobe.distribution, lobe.alphas, local(lobe, half)),
                stretched_lambda(lobe.distribution, lobe.alphas, local(lobe, m_wi))};
    return {half, density_of(lobe.distribution, lobe.alpha, squared_sine(lobe.normal, half)),
            lambda_of(lobe.distribution, lobe.alpha, lobe.cos_wi)};
}

Vec3f PointBsdf::evaluate_glossy(const Prepared& lobe, const Vec3f& wo) const {
    const float cos_o = glm::dot(lobe.normal, wo);
    if (cos_o <= 0.0f) return Vec3f(0.0f);
    const MirroringFacets facets = mirroring_facets(lobe, wo);
    const float lambda_o = lobe.stretched
                               ? stretched_lambda(lobe.distribution, lobe.alphas, local(lobe, wo))
                               : lambda_of(lobe.distribution, lobe.alpha, cos_o);
    const float masking = lobe.separable_masking ? (1.0f + facets.lambda_wi) * (1.0f + lambda_o)
                                                 : 1.0f + facets.lambda_wi + lambda_o;
    return lobe.weight * fresnel(lobe, glm::dot(facets.half, m_wi)) *
           (0.25f * facets.density / (lobe.cos_wi * masking));
}

float PointBsdf::pdf_glossy(const Prepared& lobe, const Vec3f& wo) const {
    const MirroringFacets facets = mirroring_facets(lobe, wo);
    if (lobe.distribution != Distribution::Ggx)  // D cos(h) is sampled, not what is visible of it
        return 0.25f * facets.density * glm::dot(lobe.normal, facets.half) /
               std::max(glm::dot(facets.half, m_wi), 1e-9f);
    return 0.25f * facets.density / (lobe.cos_wi * (1.0f + facets.lambda_wi));
}

}  // namespace granita
