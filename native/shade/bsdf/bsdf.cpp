// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/bsdf.h"

#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/glass_albedo.h"
#include "shade/bsdf/microfacet.h"
#include "shade/bsdf/refraction.h"

namespace granita {
namespace {

/// What Burley's diffuse lobe reflects back, of all of it: most where it grazes the view.
constexpr float kRetro = 0.1f;

}  // namespace

PointBsdf::PointBsdf(const SurfaceClosure& closure, const ShadingPoints& points, std::size_t point,
                     const GgxAlbedo& albedo)
    : m_wi(points.view[point]),
      m_normal(points.normal[point]),
      m_geometric_normal(points.geometric_normal[point]),
      m_round(points.round) {
    m_lobes.reserve(closure.lobes.size());
    for (std::size_t k = 0; k < closure.lobes.size(); ++k) {
        const Lobe& source = closure.lobes[k];
        Prepared lobe;
        lobe.index = k;
        lobe.kind = source.kind;
        lobe.distribution = source.distribution;
        lobe.separable_masking = source.separable_masking;
        lobe.smooth_color = source.smooth_color;
        lobe.of_glass = source.of_glass;
        lobe.cosine_bumps = source.cosine_bumps;
        lobe.retro_alone = source.retro_alone;
        lobe.fresnel = source.fresnel;
        lobe.weight = source.weight[point];
        if (lobe.weight == Vec3f(0.0f)) continue;
        lobe.normal = source.normal[point];
        lobe.cos_wi = glm::dot(lobe.normal, m_wi);
        if (!source.f0.empty()) lobe.f0 = source.f0[point];
        if (!source.f90.empty()) lobe.f90 = source.f90[point];
        if (!source.ior.empty()) lobe.ior = source.ior[point];
        const float roughness = source.roughness.empty() ? 0.0f : source.roughness[point];
        const LobeView view{m_wi, lobe.normal, m_geometric_normal, lobe.cos_wi};
        if (lobe.kind == LobeKind::Diffuse) {
            if (source.burley)
                lobe.burley = roughness;
            else
                prepare_diffuse(lobe, source, point);
            lobe.importance = mean_size(lobe.weight) * (lobe.retro_alone ? kRetro : 1.0f);
        } else if (is_shaped(lobe.kind)) {
            lobe.shape = make_shape(source, point, view);
            if (!lobe.shape) continue;
            lobe.importance = mean_size(lobe.weight * lobe.shape->albedo());
        } else {
            if (lobe.cos_wi <= 0.0f) continue;  // seen from below: reflects nothing
            if (lobe.fresnel == FresnelKind::None && source.f0.empty()) lobe.f0 = Vec3f(1.0f);
            if (!source.more.empty())
                lobe.film = {source.more[0][point], source.more[1][point], source.film_spectrum};
            prepare_microfacets(lobe, roughness);
            if (!source.tangent.empty()) stretch(lobe, source.tangent[point], source.aspect[point]);
            if (lobe.kind == LobeKind::Refraction) {
                prepare_refraction(lobe);
            } else if (lobe.distribution == Distribution::AshikhminShirley) {
                lobe.shape =
                    make_ashikhmin_shirley(view, lobe.stretched ? lobe.x : Basis(lobe.normal).x,
                                           lobe.stretched ? lobe.alphas : Vec2f(lobe.alpha));
                lobe.sharp = false;
            } else if (source.multiscatter && source.distribution == Distribution::Ggx) {
                const bool is_blurred = !source.made.empty() && source.made[point] >= 0.0f;
                compensate(lobe, is_blurred ? source.made[point] : std::sqrt(lobe.alpha), albedo);
            }
            lobe.importance = mean_size(lobe.weight * taken(lobe, lobe.cos_wi));
        }
        m_transmits = m_transmits || granita::transmits(lobe.kind);
        m_importance += lobe.importance;
        m_lobes.push_back(lobe);
    }
    if (!closure.transparency.empty() && m_importance > 0.0f)
        m_part_of_all = m_importance / (m_importance + mean_size(closure.transparency[point]));
    for (Prepared& lobe : m_lobes)
        lobe.importance = m_importance > 0.0f ? lobe.importance / m_importance
                                              : 1.0f / static_cast<float>(m_lobes.size());
    for (Prepared& lobe : m_lobes) {
        if (lobe.kind != LobeKind::Refraction) continue;
        float others = 0.0f;
        for (const Prepared& other : m_lobes)
            if (&other != &lobe && granita::transmits(other.kind)) others += other.importance;
        lobe.unmet_part = others > lobe.importance ? lobe.importance / others : 1.0f;
    }
}

Vec3f PointBsdf::passed(const Prepared& lobe, float cos_half) const {
    return lobe.kind == LobeKind::Refraction ? transmittance(lobe, cos_half)
                                             : fresnel(lobe, cos_half);
}

Vec3f PointBsdf::taken(const Prepared& lobe, float cos_half) const {
    const bool is_open = lobe.kind == LobeKind::Refraction && lobe.fresnel == FresnelKind::None;
    return is_open ? Vec3f(1.0f) : passed(lobe, cos_half);
}

BsdfValue PointBsdf::evaluate(const Vec3f& wo, bool is_drawn) const {
    BsdfValue value;
    for (const Prepared& lobe : m_lobes) {
        if (lobe.sharp) continue;
        if (lobe.shape)
            value.part(part_of(lobe.kind)) += evaluate_shape(lobe, wo, is_drawn);
        else if (lobe.kind == LobeKind::Diffuse)
            value.diffuse += evaluate_diffuse(lobe, wo);
        else if (lobe.kind == LobeKind::Refraction)
            value.transmission += evaluate_refraction(lobe, wo);
        else
            value.glossy += evaluate_glossy(lobe, wo);
    }
    return value;
}

Vec3f PointBsdf::evaluate_shape(const Prepared& lobe, const Vec3f& wo, bool is_drawn) const {
    const LobeShape& shape = *lobe.shape;
    const Vec3f value = lobe.weight * (is_drawn ? shape.evaluate_drawn(wo) : shape.evaluate(wo));
    if (value == Vec3f(0.0f) || part_of(lobe.kind) != LightPart::Diffuse) return value;
    return value * unshadowed(lobe, wo, is_drawn);
}

bool PointBsdf::can_see(const Vec3f& to_center, float radius) const {
    // Rounding must not hide a sphere that touches the horizon.
    const float reach = radius + 1e-5f * (radius + glm::length(to_center));
    for (const Prepared& lobe : m_lobes) {
        if (sees_all_around(lobe.kind)) return true;
        const float side = granita::transmits(lobe.kind) ? -1.0f : 1.0f;
        if (!lobe.sharp && side * glm::dot(lobe.normal, to_center) > -reach) return true;
    }
    return false;
}

BsdfValue PointBsdf::albedo() const {
    BsdfValue albedo;
    for (const Prepared& lobe : m_lobes) {
        Vec3f along_view = lobe.weight;
        if (lobe.shape) {
            along_view *= lobe.shape->albedo();
        } else if (lobe.kind != LobeKind::Diffuse) {
            along_view *= seen_part(lobe) * lobe.directional_albedo;
            if (lobe.of_glass)
                along_view *=
                    glass_directional_albedo(std::sqrt(lobe.alpha), lobe.cos_wi, lobe.ior);
        }
        albedo.part(part_of(lobe.kind)) += along_view;
    }
    return albedo;
}

float PointBsdf::pdf(std::size_t index, const Vec3f& wo) const {
    const Prepared& lobe = m_lobes[index];
    if (lobe.sharp) return 0.0f;
    if (lobe.shape) return lobe.shape->pdf(wo);
    if (lobe.kind == LobeKind::Refraction) return pdf_refraction(lobe, wo);
    const float cos_o = glm::dot(lobe.normal, wo);
    if (cos_o <= 0.0f) return 0.0f;
    return lobe.kind == LobeKind::Diffuse ? cos_o * kInversePi : pdf_glossy(lobe, wo);
}

float PointBsdf::chance(std::size_t index, const Vec3f& wo) const {
    const Prepared& lobe = m_lobes[index];
    const bool by_facets = lobe.kind == LobeKind::Refraction && !lobe.sharp && m_importance > 0.0f;
    return by_facets ? chance_of_refraction(lobe, wo) / m_importance
                     : lobe.importance * pdf(index, wo);
}

/// Hair mirrors light, and lets it through (Cycles counts the latter as transmission).
LightPart PointBsdf::counted_as(std::size_t index, const Vec3f& wo, float uniform) const {
    const Prepared& lobe = m_lobes[index];
    const bool is_either = lobe.kind == LobeKind::PrincipledHair;
    return is_either && uniform >= lobe.shape->mirrored_part(wo) ? LightPart::Transmission
                                                                 : part_of(lobe.kind);
}

bool PointBsdf::sample(std::size_t index, const Vec2f& u, Vec3f& wo) const {
    const Prepared& lobe = m_lobes[index];
    if (!draw(lobe, u, wo)) return false;
    // What bent normals send through the surface, or back, is lost (Cycles): it would meet the
    // surface itself and be reflected once more.
    return sees_all_around(lobe.kind) || leaves(granita::transmits(lobe.kind), wo);
}

bool PointBsdf::draw(const Prepared& lobe, const Vec2f& u, Vec3f& wo) const {
    if (lobe.shape) return lobe.shape->sample(u, wo);
    if (lobe.stretched) {
        const Vec3f h = sample_stretched(lobe.distribution, lobe.alphas, local(lobe, m_wi), u);
        const Vec3f y = glm::cross(lobe.normal, lobe.x);
        return turn(lobe, h.x * lobe.x + h.y * y + h.z * lobe.normal, wo);
    }
    const Basis frame(lobe.normal);
    if (lobe.kind == LobeKind::Diffuse) {
        wo = frame.to_world(sample_cosine_hemisphere(u));
        return glm::dot(lobe.normal, wo) > 0.0f;
    }
    const Vec3f half =
        frame.to_world(sample_half_vector(lobe.distribution, lobe.alpha, frame.to_local(m_wi), u));
    return turn(lobe, half, wo);
}

bool PointBsdf::deflect(std::size_t index, Vec3f& wo, Vec3f& share) const {
    const Prepared& lobe = m_lobes[index];
    share = lobe.weight * passed(lobe, lobe.cos_wi);
    return turn(lobe, lobe.normal, wo);
}

bool PointBsdf::turn(const Prepared& lobe, const Vec3f& half, Vec3f& wo) const {
    if (lobe.kind == LobeKind::Refraction)
        return refracted(m_wi, half, lobe.ior, wo) && glm::dot(lobe.normal, wo) < 0.0f &&
               leaves(true, wo);
    wo = glm::normalize(2.0f * glm::dot(half, m_wi) * half - m_wi);
    return glm::dot(lobe.normal, wo) > 0.0f && leaves(false, wo);
}

bool PointBsdf::leaves(bool through, const Vec3f& wo) const {
    if (m_round) return true;
    const float above = glm::dot(m_geometric_normal, wo);
    return through ? above < 0.0f : above >= 0.0f;
}

}  // namespace granita
