// SPDX-License-Identifier: GPL-3.0-or-later
// Hair BSDF and Principled Hair BSDF.
#include <algorithm>
#include <cmath>

#include "shade/bsdf/hair_color.h"
#include "shade/nodes/instance_value.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

/// Along curves; of meshes along u, or v.
VectorSource hair_axis(NodeBuilder& b, bool mesh_by_v) {
    const VectorSource out = b.new_source<Vec3f>();
    const Scene& scene = b.scene();
    b.add_step(
        [=, &scene](Run& run) {
            const bool is_curve =
                scene.geometry_of(*run.input().instance).kind == GeometryKind::Curves;
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const Vec3f& step = !is_curve && mesh_by_v ? points.dp_dv[i] : points.dp_du[i];
                const float length = glm::length(step);
                result[i] = length > 0.0f ? step / length : Vec3f(1.0f, 0.0f, 0.0f);
            }
        },
        {}, {out.slot});
    return out;
}

/// Of a ribbon how many rows of its points, less one, lie side by side; 1 of samples of narrow
/// ones; 0 where rays meet one, or samples a wide one, which know how far out.
FloatSource cells_across(NodeBuilder& b) {
    return b.geometry<float>([](const ShadingInput& in, std::size_t) {
        const ShadingPoints& points = *in.points;
        if (points.columns == 0) return points.narrow ? 1.0f : 0.0f;
        const std::size_t rows = points.count / points.columns;
        return static_cast<float>(rows) - 1.0f;
    });
}

/// How far a point's row lies from the middle of these, over half the width.
FloatSource cell_aside(NodeBuilder& b) {
    return b.geometry<float>([](const ShadingInput& in, std::size_t i) {
        const ShadingPoints& points = *in.points;
        if (points.columns == 0 || points.count == points.columns) return 0.0f;
        const std::size_t row = i / points.columns, last = points.count / points.columns - 1;
        return std::abs(2.0f * static_cast<float>(row) / static_cast<float>(last) - 1.0f);
    });
}

/// Factors of chance: 1 where there is none.
FloatSource varied(NodeBuilder& b, const FloatSource& random, const FloatSource& amount) {
    return b.map<float>([](float r, float a) { return 1.0f + 2.0f * (r - 0.5f) * a; }, random,
                        amount);
}

VectorSource absorption(NodeBuilder& b, const FloatSource& random, const FloatSource& radial) {
    const std::string by = b.text("parametrization", "COLOR");
    if (by == "ABSORPTION")
        return b.vector("Absorption Coefficient", Vec3f(0.245531f, 0.52f, 1.365f));
    if (by == "COLOR")
        return b.map<Vec3f>(hair_absorption,
                            b.color("Color", Vec3f(0.017513f, 0.005763f, 0.002059f)), radial);
    const FloatSource melanin =
        product(b, b.number("Melanin", 0.8f),
                varied(b, random, b.map<float>(saturate, b.number("Random Color"))));
    return b.map<Vec3f>(
        [](float amount, float red, const Vec3f& tint, float r) {
            // From what looks even between 0 and 1 to concentrations.
            const float dense = -std::log(std::max(1.0f - amount, 0.0001f));
            return melanin_absorption(dense * (1.0f - red), dense * red) + hair_absorption(tint, r);
        },
        melanin, b.number("Melanin Redness", 1.0f), b.color("Tint", Vec3f(1.0f)), radial);
}

}  // namespace

void build_hair(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    LobeSource lobe;
    lobe.kind = b.text("component", "Reflection") == "Transmission" ? LobeKind::HairTransmission
                                                                    : LobeKind::HairReflection;
    lobe.weight = scaled(b, b.color("Color", Vec3f(0.8f)), weight);
    lobe.normal = b.specular_normal();
    lobe.roughness = b.number("RoughnessU", 0.1f);
    lobe.is_stretched = true;
    FloatSource offset = b.number("Offset");
    if (b.linked("Tangent")) {
        lobe.tangent = b.map<Vec3f>(
            [](const Vec3f& t) {
                const float length = glm::length(t);
                return length > 0.0f ? t / length : Vec3f(1.0f, 0.0f, 0.0f);
            },
            b.vector("Tangent"));
    } else {
        lobe.tangent = hair_axis(b, true);
        offset = product(b, offset, is_of_kind(b, GeometryKind::Curves));
    }
    lobe.aspect = FloatSource{-1, 1.0f};
    lobe.more = {b.number("RoughnessV", 1.0f), offset};
    surface.add_lobe(lobe);
}

void build_principled_hair(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    if (b.text("model", "CHIANG") == "HUANG")
        b.warn("Huang's model is not supported; rendered as Chiang's");
    const FloatSource is_curve = is_of_kind(b, GeometryKind::Curves);
    // Each curve its own, where nothing says otherwise.
    const FloatSource random_roughness = b.number("Random Roughness");
    const bool is_even = b.number("Random Color").is(0.0f) && random_roughness.is(0.0f);
    const FloatSource random =
        is_even ? FloatSource{-1, 0.5f}
        : b.linked("Random")
            ? b.number("Random")
            : product(b, b.attribute_component({AttributeSource::ElementRandom, "", 1}, 0),
                      is_curve);
    const FloatSource factor = varied(b, random, random_roughness);
    LobeSource lobe;
    lobe.kind = LobeKind::PrincipledHair;
    lobe.weight = scaled(b, {-1, Vec3f(1.0f)}, weight);
    lobe.normal = b.shading_normal();
    lobe.roughness = product(b, b.number("Roughness", 0.3f), factor);
    const FloatSource radial = product(b, b.number("Radial Roughness", 0.3f), factor);
    lobe.is_stretched = true;
    lobe.tangent = hair_axis(b, false);
    lobe.aspect = FloatSource{-1, 1.0f};
    lobe.more = {radial,
                 b.number("Offset", 0.0349066f),
                 b.map<float>([](float coat) { return 1.0f - saturate(coat); }, b.number("Coat")),
                 product(b, cells_across(b), is_curve),
                 cell_aside(b),
                 FloatSource{-1, b.since(4, 0) ? 0.0f : 1.0f}};
    lobe.has_color = true;
    lobe.f0 = absorption(b, random, radial);
    lobe.ior = b.number("IOR", 1.55f);
    surface.add_lobe(lobe);
}

}  // namespace granita
