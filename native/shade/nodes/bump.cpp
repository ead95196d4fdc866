// SPDX-License-Identifier: GPL-3.0-or-later
// Bump: shading normals from the slope of a height.
#include <algorithm>
#include <cmath>

#include "math/normalize_or.h"
#include "shade/nodes/nodes.h"

namespace granita {

/// Mikkelsen's surface gradient (2010) with the grid's own steps as the differences.
void build_bump(NodeBuilder& b) {
    if (b.is_world()) {
        b.output_vector("Normal", b.shading_normal());
        return;
    }
    const VectorSource base = b.normal_input();
    const FloatSource height = b.number_at("Height", Shift::None),
                      height_u = b.number_at("Height", Shift::U),
                      height_v = b.number_at("Height", Shift::V),
                      strength = b.number("Strength", 1.0f), distance = b.number("Distance", 1.0f);
    const float invert = b.flag("invert") ? -1.0f : 1.0f;
    const VectorSource out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const auto normals = run.read(base);
            const auto heights = run.read(height), us = run.read(height_u), vs = run.read(height_v),
                       strengths = run.read(strength), distances = run.read(distance);
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const Vec3f& n = normals[i];
                const Vec3f across_u = glm::cross(points.dp_dv[i], n);
                const Vec3f across_v = glm::cross(n, points.dp_du[i]);
                const float determinant = glm::dot(points.dp_du[i], across_u);
                const Vec3f gradient =
                    (us[i] - heights[i]) * across_u + (vs[i] - heights[i]) * across_v;
                const float scale = distances[i] * invert * (determinant < 0.0f ? -1.0f : 1.0f);
                const Vec3f bumped = normalize_or(std::abs(determinant) * n - scale * gradient, n);
                const float s = std::max(strengths[i], 0.0f);
                result[i] = normalize_or(s * bumped + (1.0f - s) * n, n);
            }
        },
        {base.slot, height.slot, height_u.slot, height_v.slot, strength.slot, distance.slot},
        {out.slot});
    b.output_vector("Normal", out);
}

}  // namespace granita
