// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/principled_coat.h"

#include <algorithm>
#include <cmath>

#include "shade/bsdf/fresnel.h"
#include "shade/nodes/layer_albedo.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

const Vec3f kOne(1.0f);

/// Light straight through the coat is as the tint says; slanted, it goes a longer way (Beer's law).
Vec3f absorbed(const Vec3f& tint, float cosine, float ior) {
    const float inside = std::sqrt(1.0f - (1.0f - cosine * cosine) / (ior * ior));
    const float way = 1.0f / std::max(inside, 1e-6f);
    return {std::pow(tint.x, way), std::pow(tint.y, way), std::pow(tint.z, way)};
}

/// What reaches the layers below.  Since 5.3 the coat takes as much as if each facet were alone,
/// though it reflects what they hand on; and a part of the surface that it does not cover is not
/// seen through its tint, where before both shares were of the whole.
VectorSource let_through(NodeBuilder& b, const LobeSource& coat, const FloatSource& amount) {
    const bool covers = b.since(5, 3), is_smooth = coat.smooth_color;
    const bool multiscatter = coat.multiscatter && !covers;
    const FloatSource albedo = b.map<float>(
        [is_smooth, multiscatter](float ior, float roughness, const Vec3f& n, const Vec3f& view) {
            const float cosine = glm::dot(n, view);
            if (is_smooth) return fresnel_dielectric(cosine, ior);
            return layer_albedo(Vec3f(f0_from_ior(ior)), ior, roughness, cosine, multiscatter).x;
        },
        coat.ior, coat.roughness, coat.normal, b.view());
    const VectorSource passed = b.map<Vec3f>(
        [](float weight, float a) { return Vec3f(saturate(1.0f - weight * a)); }, amount, albedo);
    const VectorSource tint = b.map<Vec3f>([](const Vec3f& c) { return glm::max(c, Vec3f(0.0f)); },
                                           b.color("Coat Tint", kOne));
    if (tint.is(kOne)) return passed;
    return b.map<Vec3f>(
        [covers](const Vec3f& light, float a, const Vec3f& c, float weight, float ior,
                 const Vec3f& n, const Vec3f& view) {
            const Vec3f colored = absorbed(c, glm::dot(n, view), ior);
            if (!covers) return light * (kOne + (colored - kOne) * weight);
            return glm::max(kOne + (colored * (1.0f - a) - kOne) * weight, Vec3f(0.0f));
        },
        passed, albedo, tint, amount, coat.ior, coat.normal, b.view());
}

}  // namespace

VectorSource add_coat(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const FloatSource coat = b.number("Coat Weight");
    if (coat.is(0.0f)) return {-1, kOne};
    const bool first_generation = !b.since(4, 0);
    LobeSource lobe;
    lobe.kind = LobeKind::Glossy;
    lobe.multiscatter = b.since(4, 5);   // whatever the node's distribution
    lobe.smooth_color = !b.since(4, 5);  // and takes as much from what is below
    lobe.separable_masking = first_generation;
    if (first_generation) lobe.distribution = Distribution::Gtr1;
    lobe.fresnel = FresnelKind::Dielectric;
    lobe.normal = b.specular_normal("Coat Normal");
    lobe.roughness = b.map<float>(saturate, b.number("Coat Roughness", 0.03f));
    lobe.ior =
        b.map<float>([](float ior) { return std::max(ior, 1.0f); }, b.number("Coat IOR", 1.5f));
    lobe.f0 = b.map<Vec3f>([](float ior) { return Vec3f(f0_from_ior(ior)); }, lobe.ior);
    lobe.f90 = {-1, kOne};
    const float strength = first_generation ? 0.25f : 1.0f;
    const FloatSource amount =
        b.map<float>([strength](float x) { return strength * std::max(x, 0.0f); }, coat);
    lobe.weight = scaled(b, {-1, kOne}, product(b, weight, amount));
    surface.add_lobe(lobe);
    if (first_generation) return {-1, kOne};
    return let_through(b, lobe, amount);
}

}  // namespace granita
