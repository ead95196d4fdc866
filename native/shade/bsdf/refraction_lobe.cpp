// SPDX-License-Identifier: GPL-3.0-or-later
// Microfacets that refract: Walter, Marschner, Li and Torrance 2007, "Microfacet Models for
// Refraction through Rough Surfaces".  Light is not gathered where it enters a denser body: as in
// Cycles radiance, not radiance over the squared index, is kept along a path.
#include "math/luminance.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/microfacet.h"

namespace granita {
namespace {

/// So close to 1 nothing is bent, and there is no half vector.
constexpr float kLeastBend = 1e-4f;

}  // namespace

void PointBsdf::prepare_refraction(Prepared& lobe) const {
    lobe.sharp = lobe.sharp || std::abs(lobe.ior - 1.0f) < kLeastBend;
}

Vec3f PointBsdf::transmittance(const Prepared& lobe, float cos_half) const {
    if (lobe.fresnel != FresnelKind::None) return Vec3f(1.0f) - fresnel(lobe, cos_half);
    return Vec3f(fresnel_dielectric(cos_half, lobe.ior) < 1.0f ? 1.0f : 0.0f);
}

/// Walter et al., equation 16: the normal of the facets that refract wi to wo.  Where none can, as
/// what they would have to turn light by is too much for the index, Cycles takes the same formula
/// without regard to signs: under lamps frosted glass is mostly that, so it is taken here too
/// (docs/decisions/shading.md).  No sample of the lobe goes there.
bool PointBsdf::refracting_facets(const Prepared& lobe, const Vec3f& wo,
                                  RefractingFacets& out) const {
    if (glm::dot(lobe.normal, wo) >= 0.0f || !leaves(true, wo)) return false;
    const Vec3f between = lobe.ior * wo + m_wi;
    const float length2 = glm::dot(between, between);
    if (length2 <= 0.0f) return false;
    const Vec3f half = between / std::sqrt(length2);
    out.half_wi = std::abs(glm::dot(half, m_wi));
    out.half_normal = std::abs(glm::dot(half, lobe.normal));
    out.density = density_of(lobe.distribution, lobe.alpha, squared_sine(lobe.normal, half));
    out.jacobian = lobe.ior * lobe.ior * std::abs(glm::dot(half, wo)) / length2;
    const float to_wi = glm::dot(half, m_wi);
    out.are_there = to_wi * glm::dot(half, wo) < 0.0f && to_wi * glm::dot(half, lobe.normal) > 0.0f;
    return true;
}

Vec3f PointBsdf::evaluate_refraction(const Prepared& lobe, const Vec3f& wo) const {
    RefractingFacets facets;
    if (!refracting_facets(lobe, wo, facets)) return Vec3f(0.0f);
    const float lambda_i = lambda_of(lobe.distribution, lobe.alpha, lobe.cos_wi);
    const float lambda_o = lambda_of(lobe.distribution, lobe.alpha, -glm::dot(lobe.normal, wo));
    const float masking =
        lobe.separable_masking ? (1.0f + lambda_i) * (1.0f + lambda_o) : 1.0f + lambda_i + lambda_o;
    return lobe.weight * transmittance(lobe, facets.half_wi) *
           (facets.density * facets.half_wi * facets.jacobian / (lobe.cos_wi * masking));
}

float PointBsdf::pdf_refraction(const Prepared& lobe, const Vec3f& wo) const {
    RefractingFacets facets;
    if (!refracting_facets(lobe, wo, facets)) return 0.0f;
    // Where no sample of this lobe goes, others that do and lamps lose what it never brings.  In
    // Cycles that is as much as chance would take this lobe and not those (a ball of 99 %
    // Translucent and 1 % Refraction was 7 % too dark).
    return (facets.are_there ? 1.0f : lobe.unmet_part) * density_of_refraction(lobe, facets);
}

float PointBsdf::chance_of_refraction(const Prepared& lobe, const Vec3f& wo) const {
    RefractingFacets facets;
    if (!refracting_facets(lobe, wo, facets)) return 0.0f;
    return mean_size(lobe.weight * taken(lobe, facets.half_wi)) *
           density_of_refraction(lobe, facets);
}

float PointBsdf::density_of_refraction(const Prepared& lobe, const RefractingFacets& facets) const {
    if (lobe.distribution != Distribution::Ggx)
        return facets.density * facets.half_normal * facets.jacobian;
    return facets.density * facets.half_wi * facets.jacobian /
           (lobe.cos_wi * (1.0f + ggx_lambda(lobe.alpha, lobe.cos_wi)));
}

}  // namespace granita
