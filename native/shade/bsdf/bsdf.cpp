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

float average(const Vec3f& c) {
    return (c.x + c.y + c.z) * (1.0f / 3.0f);
}

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
float burley_factor(float roughness, float cos_wi_wo, float cos_i, float cos_o) {
    const float fi = schlick_weight(cos_i), fo = schlick_weight(cos_o);
    const float retro = roughness * (cos_wi_wo + 1.0f);
    return (1.0f - 0.5f * fi) * (1.0f - 0.5f * fo) + retro * (fo + fi + fo * fi * (retro - 1.0f));
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

/// The same before Blender 4: a smooth step over the cosines' ratio (Chiang, Li and Burley 2019).
float cosine_bump_shadowing(const Vec3f& surface_normal, const Vec3f& normal, const Vec3f& wo) {
    const float bent = glm::dot(surface_normal, normal) * glm::dot(normal, wo);
    const float g = bent != 0.0f ? glm::dot(surface_normal, wo) / bent : 0.0f;
    if (g >= 1.0f) return 1.0f;
    return g > 0.0f ? ((1.0f - g) * g + 1.0f) * g : 0.0f;
}

float lambda_of(Distribution distribution, float alpha, float cos_v) {
    if (distribution == Distribution::Beckmann) return beckmann_lambda(alpha, cos_v);
    constexpr float kCoatAlpha = 0.25f;
    return ggx_lambda(distribution == Distribution::Gtr1 ? kCoatAlpha : alpha, cos_v);
}

float density_of(Distribution distribution, float alpha, float sin2) {
    if (distribution == Distribution::Beckmann) return beckmann_density(alpha, sin2);
    return distribution == Distribution::Gtr1 ? gtr1_density(alpha, sin2)
                                              : ggx_density(alpha, sin2);
}

/// In the lobe's own frame; `wi` there.
Vec3f sample_half_vector(Distribution distribution, float alpha, const Vec3f& wi, const Vec2f& u) {
    if (distribution == Distribution::Beckmann) return sample_beckmann(alpha, u);
    if (distribution == Distribution::Gtr1) return sample_gtr1(alpha, u);
    return sample_ggx_visible(wi, alpha, u);
}

float squared_sine(const Vec3f& a, const Vec3f& b) {
    const Vec3f c = glm::cross(a, b);
    return std::min(glm::dot(c, c), 1.0f);
}

}  // namespace

PointBsdf::PointBsdf(const SurfaceClosure& closure, const ShadingPoints& points, std::size_t point,
                     const GgxAlbedo& albedo)
    : m_wi(points.view[point]),
      m_normal(points.normal[point]),
      m_geometric_normal(points.geometric_normal[point]) {
    m_lobes.reserve(closure.lobes.size());
    float total = 0.0f;
    for (std::size_t k = 0; k < closure.lobes.size(); ++k) {
        const Lobe& source = closure.lobes[k];
        Prepared lobe;
        lobe.index = k;
        lobe.kind = source.kind;
        lobe.distribution = source.distribution;
        lobe.separable_masking = source.separable_masking;
        lobe.cosine_bumps = source.cosine_bumps;
        lobe.fresnel = source.fresnel;
        lobe.weight = source.weight[point];
        if (lobe.weight == Vec3f(0.0f)) continue;
        lobe.normal = source.normal[point];
        lobe.cos_wi = glm::dot(lobe.normal, m_wi);
        if (!source.f0.empty()) lobe.f0 = source.f0[point];
        if (!source.f90.empty()) lobe.f90 = source.f90[point];
        if (!source.ior.empty()) lobe.ior = source.ior[point];
        const float roughness = source.roughness.empty() ? 0.0f : source.roughness[point];
        if (lobe.kind == LobeKind::Diffuse) {
            if (source.burley)
                lobe.burley = roughness;
            else
                prepare_diffuse(lobe, source.f0.empty() ? nullptr : &source.f0[point], roughness);
            lobe.importance = std::abs(average(lobe.weight));
        } else {
            if (lobe.cos_wi <= 0.0f) continue;  // seen from below: reflects nothing
            const bool compensate = source.multiscatter && source.distribution == Distribution::Ggx;
            if (lobe.fresnel == FresnelKind::None && source.f0.empty()) lobe.f0 = Vec3f(1.0f);
            prepare_glossy(lobe, roughness, compensate, albedo);
            lobe.importance = std::abs(average(lobe.weight * fresnel(lobe, lobe.cos_wi)));
        }
        total += lobe.importance;
        m_lobes.push_back(lobe);
    }
    for (Prepared& lobe : m_lobes)
        lobe.importance =
            total > 0.0f ? lobe.importance / total : 1.0f / static_cast<float>(m_lobes.size());
}

void PointBsdf::prepare_diffuse(Prepared& lobe, const Vec3f* color, float roughness) const {
    const float sigma = std::clamp(roughness, 0.0f, 1.0f);
    if (sigma < 1e-5f) return;
    lobe.oren_a = 1.0f / (kPi + sigma * (0.5f * kPi - 2.0f / 3.0f));
    lobe.oren_b = sigma * lobe.oren_a;
    if (color == nullptr) return;
    // Energy-preserving multiple scattering of the OpenPBR specification.
    const Vec3f albedo = glm::clamp(*color, Vec3f(0.0f), Vec3f(1.0f));
    const float mean = lobe.oren_a * kPi + (2.0f * kPi - 5.6f) / 3.0f * lobe.oren_b;
    const float seen = lobe.oren_a * kPi + lobe.oren_b * oren_nayar_g(std::max(lobe.cos_wi, 0.0f));
    lobe.oren_multiscatter = kInversePi * albedo * albedo * (mean / (1.0f - mean)) /
                             (Vec3f(1.0f) - albedo * (1.0f - mean)) * (1.0f - seen);
}

void PointBsdf::prepare_glossy(Prepared& lobe, float roughness, bool multiscatter,
                               const GgxAlbedo& albedo) const {
    const float clamped = std::clamp(roughness, 0.0f, 1.0f);
    lobe.alpha = clamped * clamped;
    lobe.sharp = lobe.distribution == Distribution::Sharp || lobe.alpha <= kSharpAlpha;
    lobe.f0_real = f0_from_ior(lobe.ior);
    if (lobe.fresnel == FresnelKind::F82Tint) lobe.dip = f82_dip(lobe.f0, lobe.f90);
    if (!multiscatter || lobe.sharp) return;
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

Vec3f PointBsdf::evaluate_diffuse(const Prepared& lobe, const Vec3f& wo) const {
    const float cos_o = glm::dot(lobe.normal, wo);
    if (cos_o <= 0.0f) return Vec3f(0.0f);
    Vec3f value(cos_o * kInversePi);
    if (lobe.burley >= 0.0f) {
        value *= burley_factor(lobe.burley, glm::dot(wo, m_wi), lobe.cos_wi, cos_o);
    } else if (lobe.oren_b > 0.0f) {
        const float cos_i = std::max(lobe.cos_wi, 0.0f);
        float t = glm::dot(wo, m_wi) - cos_o * cos_i;
        if (t > 0.0f) t /= std::max(cos_o, cos_i);
        const float lost =
            1.0f - (lobe.oren_a * kPi + lobe.oren_b * oren_nayar_g(std::min(cos_o, 1.0f)));
        value = cos_o * (Vec3f(lobe.oren_a + lobe.oren_b * t) + lobe.oren_multiscatter * lost);
    }
    if (lobe.normal != m_normal) {
        if (glm::dot(m_normal, wo) < 0.0f) return Vec3f(0.0f);  // through the surface
        value *= lobe.cosine_bumps ? cosine_bump_shadowing(m_normal, lobe.normal, wo)
                                   : bump_shadowing(m_normal, lobe.normal, wo);
    }
    return lobe.weight * value;
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

BsdfValue PointBsdf::evaluate(const Vec3f& wo) const {
    BsdfValue value;
    for (const Prepared& lobe : m_lobes) {
        if (lobe.kind == LobeKind::Diffuse)
            value.diffuse += evaluate_diffuse(lobe, wo);
        else if (!lobe.sharp)
            value.glossy += evaluate_glossy(lobe, wo);
    }
    return value;
}

bool PointBsdf::can_see(const Vec3f& to_center, float radius) const {
    // Rounding must not hide a sphere that touches the horizon.
    const float reach = radius + 1e-5f * (radius + glm::length(to_center));
    for (const Prepared& lobe : m_lobes)
        if (!lobe.sharp && glm::dot(lobe.normal, to_center) > -reach) return true;
    return false;
}

BsdfValue PointBsdf::albedo() const {
    BsdfValue albedo;
    for (const Prepared& lobe : m_lobes) {
        if (lobe.kind == LobeKind::Diffuse)
            albedo.diffuse += lobe.weight;
        else
            albedo.glossy += lobe.weight * fresnel(lobe, lobe.cos_wi) * lobe.directional_albedo;
    }
    return albedo;
}

float PointBsdf::pdf(std::size_t index, const Vec3f& wo) const {
    const Prepared& lobe = m_lobes[index];
    const float cos_o = glm::dot(lobe.normal, wo);
    if (cos_o <= 0.0f || lobe.sharp) return 0.0f;
    if (lobe.kind == LobeKind::Diffuse) return cos_o * kInversePi;
    const Vec3f half = glm::normalize(m_wi + wo);
    const float d = density_of(lobe.distribution, lobe.alpha, squared_sine(lobe.normal, half));
    if (lobe.distribution != Distribution::Ggx)  // D cos(h) is sampled, not what is visible of it
        return 0.25f * d * glm::dot(lobe.normal, half) / std::max(glm::dot(half, m_wi), 1e-9f);
    return 0.25f * d / (lobe.cos_wi * (1.0f + ggx_lambda(lobe.alpha, lobe.cos_wi)));
}

bool PointBsdf::sample(std::size_t index, const Vec2f& u, Vec3f& wo) const {
    const Prepared& lobe = m_lobes[index];
    const Basis frame(lobe.normal);
    if (lobe.kind == LobeKind::Diffuse) {
        wo = frame.to_world(sample_cosine_hemisphere(u));
        return glm::dot(lobe.normal, wo) > 0.0f;
    }
    const Vec3f half =
        frame.to_world(sample_half_vector(lobe.distribution, lobe.alpha, frame.to_local(m_wi), u));
    wo = glm::normalize(2.0f * glm::dot(half, m_wi) * half - m_wi);
    return glm::dot(lobe.normal, wo) > 0.0f && glm::dot(m_geometric_normal, wo) >= 0.0f;
}

bool PointBsdf::reflect(std::size_t index, Vec3f& wo, Vec3f& reflectance) const {
    const Prepared& lobe = m_lobes[index];
    wo = glm::normalize(2.0f * lobe.cos_wi * lobe.normal - m_wi);
    reflectance = lobe.weight * fresnel(lobe, lobe.cos_wi);
    return glm::dot(m_geometric_normal, wo) >= 0.0f;
}

}  // namespace granita
