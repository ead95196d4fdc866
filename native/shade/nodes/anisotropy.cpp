// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/anisotropy.h"

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/nodes/tangent.h"

namespace granita {

namespace {

void stretch(NodeBuilder& b, LobeSource& lobe, const std::string& rotation,
             const FloatSource& aspect) {
    lobe.is_stretched = true;
    lobe.aspect = aspect;
    const VectorSource tangent = b.linked("Tangent") ? b.vector("Tangent") : default_tangent(b);
    lobe.tangent = turned(b, tangent, lobe.normal, b.number(rotation));
}

}  // namespace

VectorSource default_tangent(NodeBuilder& b) {
    const VectorSource around = radial_tangent(b, RadialAxis::Z), out = b.new_source<Vec3f>();
    const Scene& scene = b.scene();
    b.add_step(
        [=, &scene](Run& run) {
            const auto radial = run.read(around);
            const bool is_curve =
                scene.geometry_of(*run.input().instance).kind == GeometryKind::Curves;
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const bool along = is_curve || radial[i] == Vec3f(0.0f);
                const Vec3f& step = points.dp_du[i];
                const float length = glm::length(step);
                result[i] = along && length > 0.0f ? step / length : radial[i];
            }
        },
        {around.slot}, {out.slot});
    return out;
}

VectorSource turned(NodeBuilder& b, const VectorSource& v, const VectorSource& axis,
                    const FloatSource& turn) {
    if (turn.is(0.0f)) return v;
    return b.map<Vec3f>(
        [](const Vec3f& x, const Vec3f& n, float t) {
            const float angle = 2.0f * kPi * t, c = std::cos(angle);
            return c * x + std::sin(angle) * glm::cross(n, x) +
                   (1.0f - c) * glm::dot(n, x) * n;  // Rodrigues
        },
        v, axis, turn);
}

void stretch_by_socket(NodeBuilder& b, LobeSource& lobe, const std::string& amount,
                       const std::string& rotation) {
    const FloatSource anisotropic = b.number(amount);
    if (anisotropic.is(0.0f)) return;
    const bool first = !b.since(4, 0);
    stretch(b, lobe, rotation,
            b.map<float>(
                [first](float x) {
                    const float bounded = first ? x : std::clamp(x, 0.0f, 1.0f);
                    return std::sqrt(std::max(1.0f - 0.9f * bounded, 1e-6f));
                },
                anisotropic));
}

void stretch_both_ways(NodeBuilder& b, LobeSource& lobe) {
    const FloatSource anisotropy = b.number("Anisotropy");
    if (anisotropy.is(0.0f)) return;
    stretch(b, lobe, "Rotation",
            b.map<float>(
                [](float x) {
                    const float bounded = std::clamp(x, -0.99f, 0.99f);
                    return bounded < 0.0f ? 1.0f + bounded : 1.0f / (1.0f - bounded);
                },
                anisotropy));
}

}  // namespace granita
