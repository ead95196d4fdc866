// SPDX-License-Identifier: GPL-3.0-or-later
// Principled BSDF, both generations, as Cycles builds them from lobes.
//
//   generation 1 (before Blender 4): Burley's diffuse, a specular lobe that fades from dielectric
//   to
//       metallic by its colour at normal incidence, side by side
//   generation 2: a coat over a metallic lobe and a dielectric one, which takes its albedo from the
//       diffuse layer below
//
// Beside the specular and diffuse ones, as far as it transmits, glass; sheen beside the first's
// diffuse layer and over all of the second.  Subsurface takes the place of the first's diffuse
// layer, of a share of the second's.
#include <algorithm>
#include <cmath>

#include "shade/bsdf/fresnel.h"
#include "shade/bsdf/sheen_table.h"
#include "shade/nodes/anisotropy.h"
#include "shade/nodes/glass.h"
#include "shade/nodes/layer_albedo.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/principled_coat.h"
#include "shade/nodes/scalar_math.h"
#include "shade/nodes/subsurface.h"
#include "shade/nodes/thin_wall.h"

namespace granita {

namespace {

const Vec3f kOne(1.0f);

struct Common {
    FloatSource weight;     ///< alpha applied
    VectorSource emission;  ///< weighted
    VectorSource base_color, normal;
    VectorSource specular_normal;  ///< of glossy lobes, of which subsurface is one in Cycles
    FloatSource metallic, roughness, transmission, specular, ior;
    bool multiscatter = false;
    bool is_thin = false;  ///< of no depth
    FilmSource film;
};

void add_alpha(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight,
               const FloatSource& alpha) {
    const FloatSource clear = b.map<float>([](float a) { return 1.0f - a; }, alpha);
    surface.add_transparency(b, scaled(b, {-1, kOne}, product(b, weight, clear)));
}

LobeSource glossy_lobe(const Common& c) {
    LobeSource lobe;
    lobe.kind = LobeKind::Glossy;
    lobe.multiscatter = c.multiscatter;
    lobe.normal = c.specular_normal;
    lobe.roughness = c.roughness;
    return lobe;
}

/// Shared by Fresnel along the view; the reflection is tinted as it is at normal incidence.
void add_first_glass(NodeBuilder& b, SurfaceBuilder& surface, const Common& c,
                     const FloatSource& tint) {
    GlassSource glass;
    glass.sent = c.base_color;
    glass.normal = c.specular_normal;
    glass.roughness = c.roughness;
    glass.ior = relative_ior(b, c.ior);
    glass.multiscatter = c.multiscatter;
    const FloatSource share = product(
        b, c.weight,
        b.map<float>([](float m, float t) { return (1.0f - m) * t; }, c.metallic, c.transmission));
    glass.weight = scaled(b, compensated(b, glass), share);
    const FloatSource fresnel = view_fresnel(b, glass.normal, glass.ior);

    LobeSource sent;
    sent.kind = LobeKind::Refraction;
    sent.separable_masking = true;
    sent.normal = glass.normal;
    sent.ior = glass.ior;
    LobeSource reflected = sent;
    reflected.kind = LobeKind::Glossy;
    reflected.smooth_color = true;
    reflected.fresnel = FresnelKind::Dielectric;
    reflected.roughness = c.roughness;
    reflected.f0 = b.map<Vec3f>(
        [](const Vec3f& base, float t) {
            return glm::clamp(base * t + Vec3f(1.0f - t), Vec3f(0.0f), kOne);
        },
        c.base_color, tint);
    reflected.f90 = {-1, kOne};
    reflected.weight = scaled(b, glass.weight, fresnel);
    surface.add_lobe(reflected);
    // Only GGX has a roughness of its own for what goes through.
    sent.roughness =
        c.multiscatter
            ? c.roughness
            : b.map<float>(
                  [](float r, float t) { return 1.0f - (1.0f - r) * (1.0f - saturate(t)); },
                  c.roughness, b.number("Transmission Roughness"));
    sent.weight = scaled(b, product(b, glass.weight, c.base_color),
                         b.map<float>([](float f) { return 1.0f - f; }, fresnel));
    surface.add_lobe(sent);
}

/// What tints take of a colour.  The first generation knows its luminance by Disney's weights.
Vec3f first_hue(const Vec3f& color) {
    const float light = glm::dot(color, Vec3f(0.3f, 0.6f, 0.1f));
    return light > 0.0f ? color / light : kOne;
}

/// Cloth that shines where it grazes the light.
void add_first_sheen(NodeBuilder& b, SurfaceBuilder& surface, const Common& c,
                     const LobeSource& diffuse) {
    const FloatSource sheen = b.number("Sheen Weight");
    if (sheen.is(0.0f)) return;
    LobeSource lobe;
    lobe.kind = LobeKind::GrazingSheen;
    lobe.cosine_bumps = true;
    lobe.normal = diffuse.normal;
    lobe.roughness = FloatSource{-1, 0.0f};
    const VectorSource color = b.map<Vec3f>(
        [](const Vec3f& base, float tint) { return kOne * (1.0f - tint) + first_hue(base) * tint; },
        c.base_color, b.number("Sheen Tint", 0.5f));
    const FloatSource share = b.map<float>(
        [](float s, float m, float t) { return std::max(s, 0.0f) * (1.0f - m) * (1.0f - t); },
        sheen, c.metallic, c.transmission);
    lobe.weight = scaled(b, color, product(b, c.weight, share));
    surface.add_lobe(lobe);
}

/// What it leaves to the layers below.
FloatSource add_second_sheen(NodeBuilder& b, SurfaceBuilder& surface, const Common& c) {
    const FloatSource sheen = b.number("Sheen Weight");
    if (sheen.is(0.0f)) return {-1, 1.0f};
    LobeSource lobe;
    lobe.kind = LobeKind::Sheen;
    lobe.cosine_bumps = !b.since(4, 5);
    lobe.normal = c.normal;
    const FloatSource coat = b.number("Coat Weight");
    if (!coat.is(0.0f))
        lobe.normal = b.map<Vec3f>(
            [](const Vec3f& n, const Vec3f& over, float w) {
                const Vec3f mixed = n + (over - n) * saturate(w);
                const float length = glm::length(mixed);
                return length > 0.0f ? mixed / length : n;
            },
            c.normal, b.diffuse_normal("Coat Normal"), coat);
    lobe.roughness = b.map<float>(saturate, b.number("Sheen Roughness", 0.5f));
    const VectorSource tint = b.map<Vec3f>(
        [](const Vec3f& t, float w) { return glm::max(t, Vec3f(0.0f)) * std::max(w, 0.0f); },
        b.color("Sheen Tint", kOne), sheen);
    lobe.weight = scaled(b, tint, c.weight);
    surface.add_lobe(lobe);
    return b.map<float>(
        [](const Vec3f& color, float roughness, const Vec3f& n, const Vec3f& view) {
            const float albedo = sheen_fit(glm::dot(n, view), roughness).albedo;
            return saturate(1.0f - albedo * largest(color));
        },
        tint, lobe.roughness, lobe.normal, b.view());
}

/// Sockets under their names of Blender 4; the exporter renames older ones.
SubsurfaceSource subsurface_of(NodeBuilder& b, const Common& c, const FloatSource& scale) {
    SubsurfaceSource lobe;
    lobe.normal = c.specular_normal;
    lobe.radius = scaled(b, b.vector("Subsurface Radius", Vec3f(1.0f, 0.2f, 0.1f)), scale);
    lobe.alpha = b.map<float>([](float r) { return r * r; }, c.roughness);
    lobe.anisotropy = b.number("Subsurface Anisotropy");
    lobe.ior = b.number("Subsurface IOR", 1.4f);
    return lobe;
}

/// As far as there is any, it takes the place of `diffuse` but for what that reflects back, in a
/// colour of its own; the more, the farther it reaches.
void add_first_subsurface(NodeBuilder& b, SurfaceBuilder& surface, const Common& c,
                          LobeSource& diffuse, const FloatSource& share) {
    const FloatSource amount = b.map<float>(saturate, b.number("Subsurface Weight"));
    if (amount.is(0.0f)) return;
    SubsurfaceSource lobe = subsurface_of(b, c, amount);
    lobe.burley = true;
    lobe.albedo =
        b.map<Vec3f>([](const Vec3f& base, const Vec3f& below,
                        float s) { return base * (1.0f - s) + glm::max(below, Vec3f(0.0f)) * s; },
                     c.base_color, b.color("Subsurface Color", Vec3f(0.8f)), amount);
    const VectorSource all = scaled(b, lobe.albedo, share);
    const FloatSource is_there =
        b.map<float>([](float s) { return s > 0.0f ? 1.0f : 0.0f; }, amount);
    lobe.weight = scaled(b, all, is_there);
    set_subsurface_method(b, lobe, "subsurface_method");
    surface.add_subsurface(lobe);
    LobeSource back = diffuse;
    back.retro_alone = true;
    back.weight = scaled(b, all, is_there);
    surface.add_lobe(back);
    diffuse.weight =
        scaled(b, diffuse.weight, b.map<float>([](float there) { return 1.0f - there; }, is_there));
}

/// Returns what is left to diffuse, whose weight is not known before.  `ior`: of the specular
/// layer.
FloatSource add_second_subsurface(NodeBuilder& b, SurfaceBuilder& surface, const Common& c,
                                  const FloatSource& ior, const VectorSource& weight,
                                  LobeSource diffuse) {
    const FloatSource amount = b.map<float>(saturate, b.number("Subsurface Weight"));
    if (amount.is(0.0f)) return {-1, 1.0f};
    const FloatSource rest = b.map<float>([](float s) { return 1.0f - s; }, amount);
    if (c.is_thin) {
        if (diffuse.has_color)
            b.warn("Diffuse Roughness of what a Thin Wall lets through is not supported; it is 0");
        diffuse.weight = scaled(b, product(b, c.base_color, weight), amount);
        add_thin_subsurface(b, surface, diffuse, b.number("Subsurface Anisotropy"));
        return rest;
    }
    SubsurfaceSource lobe = subsurface_of(b, c, b.number("Subsurface Scale", 0.05f));
    lobe.albedo =
        b.map<Vec3f>([](const Vec3f& base) { return glm::min(base, kOne); }, c.base_color);
    if (b.text("subsurface_method") != "RANDOM_WALK_SKIN") lobe.ior = ior;
    lobe.weight = scaled(b, product(b, lobe.albedo, weight), amount);
    set_subsurface_method(b, lobe, "subsurface_method");
    surface.add_subsurface(lobe);
    return rest;
}

void add_first_generation(NodeBuilder& b, SurfaceBuilder& surface, const Common& c) {
    surface.add_emission(b, c.emission);  // a node of its own in Cycles: in either socket
    LobeSource diffuse;
    diffuse.kind = LobeKind::Diffuse;
    diffuse.burley = true;
    diffuse.cosine_bumps = true;
    diffuse.normal = c.normal;
    diffuse.roughness = c.roughness;
    const FloatSource share =
        product(b, c.weight,
                b.map<float>([](float m, float t) { return (1.0f - m) * (1.0f - t); }, c.metallic,
                             c.transmission));
    diffuse.weight = scaled(b, c.base_color, share);
    add_first_subsurface(b, surface, c, diffuse, share);
    surface.add_lobe(diffuse);
    add_first_sheen(b, surface, c, diffuse);

    const FloatSource tint = b.number("Specular Tint");
    LobeSource specular = glossy_lobe(c);
    specular.separable_masking = specular.smooth_color = true;
    specular.fresnel = FresnelKind::Dielectric;
    specular.ior = b.map<float>(
        [](float s) { return 2.0f / (1.0f - std::sqrt(0.08f * std::max(s, 0.0f))) - 1.0f; },
        c.specular);
    specular.f0 = b.map<Vec3f>(
        [](const Vec3f& base, float m, float s, float t) {
            const Vec3f tinted = kOne * (1.0f - t) + first_hue(base) * t;
            return std::max(s, 0.0f) * 0.08f * tinted * (1.0f - m) + base * m;
        },
        c.base_color, c.metallic, c.specular, tint);
    specular.f90 = {-1, kOne};
    const FloatSource opaque = b.map<float>([](float t, float m) { return 1.0f - t * (1.0f - m); },
                                            c.transmission, c.metallic);
    specular.weight = scaled(b, {-1, kOne}, product(b, c.weight, opaque));
    stretch_by_socket(b, specular, "Anisotropic", "Anisotropic Rotation");
    if (!(c.specular.is(0.0f) && c.metallic.is(0.0f))) surface.add_lobe(specular);
    if (!c.transmission.is(0.0f)) add_first_glass(b, surface, c, tint);
    add_coat(b, surface, c.weight);
}

void add_metal(NodeBuilder& b, SurfaceBuilder& surface, const Common& c, const VectorSource& coated,
               const VectorSource& tint) {
    const auto reflectance = [](const Vec3f& v) { return glm::clamp(v, Vec3f(0.0f), kOne); };
    LobeSource metal = glossy_lobe(c);
    // Before Blender 5 metals have none.
    if (b.since(5, 0)) cover(metal, c.film);
    // With a white tint F82 is Schlick's.
    const bool schlick = tint.is(kOne) && metal.more.empty();
    metal.fresnel = schlick ? FresnelKind::Schlick : FresnelKind::F82Tint;
    metal.f0 = b.map<Vec3f>(reflectance, c.base_color);
    metal.f90 = b.map<Vec3f>(reflectance, tint);
    metal.weight = scaled(b, coated, product(b, c.weight, c.metallic));
    stretch_by_socket(b, metal, "Anisotropic", "Anisotropic Rotation");
    surface.add_lobe(metal);
}

void add_second_glass(NodeBuilder& b, SurfaceBuilder& surface, const Common& c,
                      const VectorSource& weight, const VectorSource& tint) {
    GlassSource glass;
    glass.weight = weight;
    glass.reflected = {-1, kOne};
    // Through a body light passes two of them.
    glass.sent = b.map<Vec3f>(
        [thin = c.is_thin](const Vec3f& base) {
            const Vec3f color = glm::clamp(base, Vec3f(0.0f), kOne);
            return thin ? color : glm::sqrt(color);
        },
        c.base_color);
    glass.normal = c.specular_normal;
    glass.roughness = c.roughness;
    glass.ior = relative_ior(b, c.ior);
    glass.f0 = b.map<Vec3f>(
        [](float ior, const Vec3f& t) {
            return glm::clamp(f0_from_ior(ior) * t, Vec3f(0.0f), kOne);
        },
        c.ior, tint);
    glass.multiscatter = c.multiscatter;
    glass.film = c.film;
    if (c.is_thin) {
        glass.reflected = tint;
        glass.ior = c.ior;
        add_thin_glass(b, surface, glass);
        return;
    }
    if (!b.number("Transmission Dispersion Scale").is(0.0f))
        b.warn("dispersion is not supported; glass bends all colours alike");
    add_glass(b, surface, glass);
}

void add_second_generation(NodeBuilder& b, SurfaceBuilder& surface, Common c) {
    const FloatSource below_sheen = add_second_sheen(b, surface, c);
    c.weight = product(b, c.weight, below_sheen);
    c.emission = scaled(b, c.emission, below_sheen);
    const VectorSource coated = add_coat(b, surface, c.weight);
    surface.add_emission_in(SurfaceBuilder::Socket::Surface, b, product(b, c.emission, coated));

    const VectorSource tint = b.color("Specular Tint", kOne);
    if (!c.metallic.is(0.0f)) add_metal(b, surface, c, coated, tint);

    const FloatSource no_metal =
        product(b, c.weight, b.map<float>([](float m) { return 1.0f - m; }, c.metallic));
    if (!c.transmission.is(0.0f))
        add_second_glass(b, surface, c, scaled(b, coated, product(b, no_metal, c.transmission)),
                         tint);
    const FloatSource rest =
        product(b, no_metal, b.map<float>([](float t) { return 1.0f - t; }, c.transmission));
    LobeSource specular = glossy_lobe(c);
    specular.fresnel = FresnelKind::Dielectric;
    specular.ior = b.map<float>(
        [](float ior, float level) {
            if (level == 0.5f) return ior;
            const float eta = ior_from_f0(f0_from_ior(ior) * 2.0f * std::max(level, 0.0f));
            return ior < 1.0f ? 1.0f / eta : eta;
        },
        c.ior, c.specular);
    specular.f0 = b.map<Vec3f>(
        [](float ior, const Vec3f& t) { return f0_from_ior(ior) * glm::max(t, Vec3f(0.0f)); },
        specular.ior, tint);
    specular.f90 = {-1, kOne};
    specular.weight = scaled(b, coated, rest);
    stretch_by_socket(b, specular, "Anisotropic", "Anisotropic Rotation");
    cover(specular, c.film);
    if (!specular.ior.is(1.0f) || c.film.is_there()) surface.add_lobe(specular);

    // Light that the specular layer reflects does not reach the diffuse one.
    const bool multiscatter = c.multiscatter;
    const FloatSource below = b.map<float>(
        [multiscatter, spectrum = c.film.spectrum](const Vec3f& f0, float ior, float roughness,
                                                   const Vec3f& n, const Vec3f& view,
                                                   float thickness, float film_ior) {
            const ThinFilm film{thickness, film_ior, spectrum};
            if (ior == 1.0f && !film.is_there()) return 1.0f;
            const Vec3f albedo =
                layer_albedo(f0, ior, roughness, glm::dot(n, view), multiscatter, film);
            return saturate(1.0f - largest(albedo));
        },
        specular.f0, specular.ior, c.roughness, c.specular_normal, b.view(), c.film.thickness,
        c.film.ior);
    const VectorSource reached = scaled(b, coated, product(b, rest, below));
    LobeSource diffuse;
    diffuse.kind = LobeKind::Diffuse;
    diffuse.normal = c.normal;
    diffuse.roughness = b.map<float>(saturate, b.number("Diffuse Roughness"));
    diffuse.cosine_bumps = !b.since(4, 5);
    diffuse.has_color = !diffuse.roughness.is(0.0f);
    diffuse.deepens_color = !b.since(5, 3);
    diffuse.f0 = c.base_color;
    diffuse.weight = scaled(b, product(b, c.base_color, reached),
                            add_second_subsurface(b, surface, c, specular.ior, reached, diffuse));
    surface.add_lobe(diffuse);
}

}  // namespace

void build_principled(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const FloatSource alpha = b.map<float>(saturate, b.number("Alpha", 1.0f));
    add_alpha(b, surface, weight, alpha);
    Common c;
    c.weight = product(b, weight, alpha);
    const VectorSource emission = b.color("Emission Color", Vec3f(0.0f));
    const FloatSource strength = b.number("Emission Strength", 1.0f);
    c.emission = scaled(b, emission, product(b, c.weight, strength));

    const bool first = !b.since(4, 0);
    c.base_color = b.map<Vec3f>([](const Vec3f& v) { return glm::max(v, Vec3f(0.0f)); },
                                b.color("Base Color", Vec3f(0.8f)));
    c.normal = b.diffuse_normal();
    c.specular_normal = b.specular_normal();
    c.metallic = b.map<float>(saturate, b.number("Metallic"));
    c.roughness = b.map<float>(saturate, b.number("Roughness", 0.5f));
    c.transmission = b.map<float>(saturate, b.number("Transmission Weight"));
    c.specular = b.number("Specular IOR Level", 0.5f);
    c.ior = b.map<float>([](float ior) { return std::max(ior, 1e-5f); }, b.number("IOR", 1.45f));
    c.multiscatter = b.text("distribution", "GGX") == "MULTI_GGX";
    const FloatSource thin = b.number("Thin Wall");
    c.is_thin = thin.is_constant() && !thin.is(0.0f);
    if (!thin.is_constant()) b.warn("a Thin Wall that varies is not supported; rendered as off");
    if (first) {
        add_first_generation(b, surface, c);
    } else {
        c.film = film_source(b);
        add_second_generation(b, surface, c);
    }
}

}  // namespace granita
