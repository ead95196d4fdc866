// SPDX-License-Identifier: GPL-3.0-or-later
// Diffuse, Glossy and Transparent: one closure each.  They also stand for their unsupported kin
// (node_registry.cpp).
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
    lobe.cosine_bumps = b.value("generation", 2) < 2;
    // Of the kin only Diffuse itself has a roughness that means Oren-Nayar's sigma.
    lobe.roughness = b.node().type == "ShaderNodeBsdfDiffuse" ? clamped_roughness(b, 0.0f)
                                                              : FloatSource{-1, 0.0f};
    // Since Blender 4 light that bounces inside a rough surface takes on its colour.
    lobe.has_color = b.value("generation", 2) >= 2 && !lobe.roughness.is(0.0f);
    surface.add_lobe(lobe);
}

void build_glossy(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const std::string distribution = b.text("distribution", "GGX");
    LobeSource lobe;
    lobe.kind = LobeKind::Glossy;
    lobe.multiscatter = distribution == "MULTI_GGX";
    lobe.distribution = distribution == "SHARP"      ? Distribution::Sharp
                        : distribution == "BECKMANN" ? Distribution::Beckmann
                                                     : Distribution::Ggx;
    if (distribution == "ASHIKHMIN_SHIRLEY")
        b.warn("Ashikhmin-Shirley is not supported; rendered as GGX");
    lobe.separable_masking = b.value("generation", 2) < 2;
    lobe.has_color = lobe.multiscatter;
    lobe.f0 = b.color("Color", Vec3f(0.8f));
    lobe.weight = scaled(b, lobe.f0, weight);
    lobe.normal = b.specular_normal();
    lobe.roughness = clamped_roughness(b, 0.5f);
    surface.add_lobe(lobe);
}

void build_transparent(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    surface.add_transparency(b, scaled(b, b.color("Color", Vec3f(1.0f)), weight));
}

}  // namespace granita
