// SPDX-License-Identifier: GPL-3.0-or-later
// Bump: shading normals from the slope of a height.
#include <algorithm>
#include <cmath>

#include "math/normalize_or.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

/// A height at a point and the filter's width from there along u and v.
struct Heights {
    FloatSource here, next_u, next_v;
};

/// Mikkelsen's surface gradient (2010) with the points' own steps, along which heights are told
/// apart over the Filter Width.
VectorSource bumped_normal(NodeBuilder& b, const VectorSource& base, const Heights& height,
                           const FloatSource& strength, const FloatSource& distance, float sign) {
    const VectorSource out = b.new_source<Vec3f>();
    b.add_step(
        [=, width = b.bump_width()](Run& run) {
            const auto normals = run.read(base);
            const auto heights = run.read(height.here), us = run.read(height.next_u),
                       vs = run.read(height.next_v), strengths = run.read(strength),
                       distances = run.read(distance);
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const Vec3f& n = normals[i];
                const Vec3f across_u = glm::cross(points.dp_dv[i], n);
                const Vec3f across_v = glm::cross(n, points.dp_du[i]);
                const float determinant = glm::dot(points.dp_du[i], across_u);
                const Vec3f gradient =
                    (us[i] - heights[i]) / run.step_scale(width, Shift::U, i) * across_u +
                    (vs[i] - heights[i]) / run.step_scale(width, Shift::V, i) * across_v;
                const float scale = distances[i] * sign * (determinant < 0.0f ? -1.0f : 1.0f);
                const Vec3f bumped = normalize_or(std::abs(determinant) * n - scale * gradient, n);
                const float s = std::max(strengths[i], 0.0f);
                result[i] = normalize_or(s * bumped + (1.0f - s) * n, n);
            }
        },
        {base.slot, height.here.slot, height.next_u.slot, height.next_v.slot, strength.slot,
         distance.slot},
        {out.slot});
    return out;
}

}  // namespace

void build_bump(NodeBuilder& b) {
    if (b.is_world()) {
        b.output_vector("Normal", b.shading_normal());
        return;
    }
    if (b.linked("Filter Width")) b.warn("its Filter Width is linked: 1 is taken");
    const Heights heights{b.number_at("Height", Shift::None), b.number_at("Height", Shift::U),
                          b.number_at("Height", Shift::V)};
    b.output_vector("Normal",
                    bumped_normal(b, b.normal_input(), heights, b.number("Strength", 1.0f),
                                  b.number("Distance", 1.0f), b.flag("invert") ? -1.0f : 1.0f));
}

VectorSource bumped_by_displacement(NodeBuilder& b, const VectorSource& here,
                                    const VectorSource& next_u, const VectorSource& next_v) {
    const VectorSource normal = b.geometry<Vec3f>(
        [](const ShadingInput& in, std::size_t i) { return in.points->normal[i]; });
    const auto height = [&](const VectorSource& way) {
        return b.map<float>([](const Vec3f& w, const Vec3f& n) { return glm::dot(w, n); }, way,
                            normal);
    };
    const FloatSource one{-1, 1.0f};
    return bumped_normal(b, normal, {height(here), height(next_u), height(next_v)}, one, one, 1.0f);
}

}  // namespace granita
