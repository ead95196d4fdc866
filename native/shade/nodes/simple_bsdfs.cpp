// SPDX-License-Identifier: GPL-3.0-or-later
// Shaders of one closure each.  Diffuse also stands for its unsupported kin (node_registry.cpp).
#include "shade/nodes/anisotropy.h"
#include "shade/nodes/distribution.h"
#include "shade/nodes/film.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

FloatSource clamped_roughness(NodeBuilder& b, float fallback) {
    return b.map<float>(saturate, b.number("Roughness", fallback));
}

}  // namespace

void build_diffuse(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    LobeSource lobe;
    lobe.kind = LobeKind::Diffuse;
    lobe.f0 = b.color("Color", Vec3f(0.8f));
    lobe.weight = scaled(b, lobe.f0, weight);
    lobe.normal = b.diffuse_normal();
    lobe.cosine_bumps = !b.since(4, 5);
    // Of the kin only Diffuse itself has a roughness that means Oren-Nayar's sigma.
    lobe.roughness = b.node().type == "ShaderNodeBsdfDiffuse" ? clamped_roughness(b, 0.0f)
                                                              : FloatSource{-1, 0.0f};
    // Since Blender 4.3 light that bounces inside a rough surface takes on its colour.
    lobe.has_color = b.since(4, 3) && !lobe.roughness.is(0.0f);
    lobe.deepens_color = !b.since(5, 3);
    surface.add_lobe(lobe);
}

void build_glossy(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const std::string distribution = b.text("distribution", "GGX");
    LobeSource lobe;
    lobe.kind = LobeKind::Glossy;
    lobe.multiscatter = distribution == "MULTI_GGX";
    lobe.distribution = distribution_of(distribution);
    lobe.separable_masking = !b.since(4, 0);
    lobe.has_color = lobe.multiscatter;
    lobe.f0 = b.color("Color", Vec3f(0.8f));
    lobe.weight = scaled(b, lobe.f0, weight);
    lobe.normal = b.specular_normal();
    lobe.roughness = clamped_roughness(b, 0.5f);
    stretch_both_ways(b, lobe);
    surface.add_lobe(lobe);
}

void build_metallic(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const std::string distribution = b.text("distribution", "GGX");
    LobeSource lobe;
    lobe.kind = LobeKind::Glossy;
    lobe.multiscatter = distribution == "MULTI_GGX";
    lobe.distribution = distribution_of(distribution);
    if (b.text("fresnel_type", "F82") == "PHYSICAL_CONDUCTOR") {
        const auto positive = [](const Vec3f& v) { return glm::max(v, Vec3f(0.0f)); };
        lobe.fresnel = FresnelKind::Conductor;
        lobe.f0 = b.map<Vec3f>(positive, b.vector("IOR", Vec3f(2.757f, 2.513f, 2.231f)));
        lobe.f90 = b.map<Vec3f>(positive, b.vector("Extinction", Vec3f(3.867f, 3.404f, 3.009f)));
    } else {
        const auto reflectance = [](const Vec3f& v) {
            return glm::clamp(v, Vec3f(0.0f), Vec3f(1.0f));
        };
        lobe.fresnel = FresnelKind::F82Tint;
        lobe.f0 = b.map<Vec3f>(reflectance, b.color("Base Color", Vec3f(0.617f, 0.577f, 0.54f)));
        lobe.f90 = b.map<Vec3f>(reflectance, b.color("Edge Tint", Vec3f(0.695f, 0.726f, 0.77f)));
    }
    lobe.weight = scaled(b, {-1, Vec3f(1.0f)}, weight);
    lobe.normal = b.specular_normal();
    lobe.roughness = clamped_roughness(b, 0.5f);
    stretch_by_socket(b, lobe, "Anisotropy", "Rotation");
    cover(lobe, film_source(b));
    surface.add_lobe(lobe);
}

namespace {

/// A lobe of a kind, with the node's colour and normal.
LobeSource plain_lobe(NodeBuilder& b, LobeKind kind, const FloatSource& weight) {
    LobeSource lobe;
    lobe.kind = kind;
    lobe.weight = scaled(b, b.color("Color", Vec3f(0.8f)), weight);
    lobe.normal = b.diffuse_normal();
    lobe.cosine_bumps = !b.since(4, 5);
    lobe.roughness = FloatSource{-1, 0.0f};
    return lobe;
}

}  // namespace

void build_translucent(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    LobeSource lobe = plain_lobe(b, LobeKind::Translucent, weight);
    lobe.normal = b.specular_normal();
    surface.add_lobe(lobe);
}

void build_sheen(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const bool microfiber = b.text("distribution", "MICROFIBER") == "MICROFIBER";
    LobeSource lobe = plain_lobe(b, microfiber ? LobeKind::Sheen : LobeKind::Velvet, weight);
    lobe.roughness = clamped_roughness(b, 0.5f);
    surface.add_lobe(lobe);
}

void build_velvet(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    LobeSource lobe = plain_lobe(b, LobeKind::Velvet, weight);
    lobe.roughness = b.map<float>(saturate, b.number("Sigma", 1.0f));
    surface.add_lobe(lobe);
}

void build_toon(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const bool glossy = b.text("component", "DIFFUSE") == "GLOSSY";
    LobeSource lobe = plain_lobe(b, glossy ? LobeKind::GlossyToon : LobeKind::DiffuseToon, weight);
    lobe.roughness = b.map<float>(saturate, b.number("Size", 0.5f));
    lobe.more = {b.map<float>(saturate, b.number("Smooth"))};
    surface.add_lobe(lobe);
}

/// Black, and lets nothing through: that it cuts, the whole material does (Material::holdout).
void build_holdout(NodeBuilder&, SurfaceBuilder&, const FloatSource&) {}

void build_transparent(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    surface.add_transparency(b, scaled(b, b.color("Color", Vec3f(1.0f)), weight));
}

}  // namespace granita
