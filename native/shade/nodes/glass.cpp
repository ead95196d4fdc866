// SPDX-License-Identifier: GPL-3.0-or-later
// Glass and Refraction.  Before Blender 4 the two sides of glass shared by Fresnel along the view,
// since then by that of each facet.
#include "shade/nodes/glass.h"

#include <algorithm>

#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/glass_albedo.h"
#include "shade/nodes/distribution.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

const Vec3f kOne(1.0f);

VectorSource positive_color(NodeBuilder& b) {
    return b.map<Vec3f>([](const Vec3f& c) { return glm::max(c, Vec3f(0.0f)); },
                        b.color("Color", kOne));
}

LobeSource refraction(const GlassSource& glass) {
    LobeSource lobe;
    lobe.kind = LobeKind::Refraction;
    lobe.distribution = glass.distribution;
    lobe.normal = glass.normal;
    lobe.roughness = glass.roughness;
    lobe.ior = glass.ior;
    return lobe;
}

GlassSource glass_source(NodeBuilder& b, const FloatSource& weight) {
    GlassSource glass;
    glass.weight = scaled(b, {-1, kOne}, weight);
    glass.reflected = glass.sent = positive_color(b);
    glass.normal = b.specular_normal();
    glass.roughness = b.map<float>(saturate, b.number("Roughness"));
    glass.ior = relative_ior(b, b.number("IOR", 1.45f));
    glass.f0 = b.map<Vec3f>([](float ior) { return Vec3f(f0_from_ior(ior)); }, glass.ior);
    const std::string distribution = b.text("distribution", "GGX");
    glass.distribution = distribution_of(distribution);
    glass.multiscatter = distribution == "MULTI_GGX";
    glass.film = film_source(b);
    return glass;
}

/// From inside the film's index is relative to the body's.  `ior`: as relative_ior().
FilmSource seen_from(NodeBuilder& b, FilmSource film, const FloatSource& ior) {
    film.ior = b.map<float>(
        [](float outside, float eta, float back) { return back != 0.0f ? outside * eta : outside; },
        film.ior, ior, b.backfacing());
    return film;
}

}  // namespace

FloatSource relative_ior(NodeBuilder& b, const FloatSource& ior) {
    return b.map<float>(
        [](float x, float back) {
            const float eta = std::max(x, 1e-5f);
            return back != 0.0f ? 1.0f / eta : eta;
        },
        ior, b.backfacing());
}

FloatSource view_fresnel(NodeBuilder& b, const VectorSource& normal, const FloatSource& ior) {
    return b.map<float>([](const Vec3f& n, const Vec3f& view,
                           float eta) { return fresnel_dielectric(glm::dot(n, view), eta); },
                        normal, b.view(), ior);
}

VectorSource compensated(NodeBuilder& b, const GlassSource& glass) {
    if (!glass.multiscatter || glass.roughness.is(0.0f)) return {-1, kOne};
    return b.map<Vec3f>(
        [](const Vec3f& color, float roughness, const Vec3f& n, const Vec3f& view, float ior) {
            return glass_compensation(color, roughness, saturate(glm::dot(n, view)), ior);
        },
        glass.sent, glass.roughness, glass.normal, b.view(), glass.ior);
}

void add_glass(NodeBuilder& b, SurfaceBuilder& surface, const GlassSource& glass) {
    const VectorSource weight = product(b, glass.weight, compensated(b, glass));
    LobeSource sent = refraction(glass);
    sent.fresnel = FresnelKind::Dielectric;
    sent.f0 = glass.f0;
    sent.f90 = {-1, kOne};
    sent.weight = product(b, weight, glass.sent);
    sent.of_glass = glass.multiscatter && !glass.roughness.is(0.0f) && b.since(4, 0);
    cover(sent, seen_from(b, glass.film, glass.ior));
    LobeSource reflected = sent;
    reflected.kind = LobeKind::Glossy;
    reflected.smooth_color = !b.since(4, 0);
    reflected.weight = product(b, weight, glass.reflected);
    surface.add_lobe(reflected);
    surface.add_lobe(sent);
}

void build_glass(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    GlassSource glass = glass_source(b, weight);
    if (b.since(4, 0) || glass.multiscatter) {
        add_glass(b, surface, glass);
        return;
    }
    const FloatSource fresnel = view_fresnel(b, glass.normal, glass.ior);
    LobeSource sent = refraction(glass);
    sent.separable_masking = true;
    LobeSource reflected = sent;
    reflected.kind = LobeKind::Glossy;
    const VectorSource colored = product(b, glass.weight, glass.sent);
    reflected.weight = scaled(b, colored, fresnel);
    sent.weight = scaled(b, colored, b.map<float>([](float f) { return 1.0f - f; }, fresnel));
    surface.add_lobe(reflected);
    surface.add_lobe(sent);
}

void build_refraction(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const GlassSource glass = glass_source(b, weight);
    LobeSource sent = refraction(glass);
    sent.separable_masking = !b.since(4, 0);
    sent.weight = product(b, glass.weight, b.color("Color", kOne));
    surface.add_lobe(sent);
}

}  // namespace granita
