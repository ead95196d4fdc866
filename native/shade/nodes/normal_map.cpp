// SPDX-License-Identifier: GPL-3.0-or-later
// Normal Map and Bump: perturbed shading normals.
#include <algorithm>
#include <cmath>

#include "shade/nodes/coordinates.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

Vec3f unit_or(const Vec3f& v, const Vec3f& fallback) {
    const float length = glm::length(v);
    return length > 0.0f && std::isfinite(length) ? v / length : fallback;
}

/// From the surface's normal to the map's and, above 1, beyond it.
Vec3f strengthened(const Vec3f& normal, const Vec3f& mapped, float strength) {
    return unit_or(normal + (mapped - normal) * std::max(strength, 0.0f), normal);
}

struct TangentFrame {
    Vec3f tangent, bitangent;
    bool valid = false;
};

/// Tangent along growing u of the map, orthogonal to the normal (Mikkelsen 2008 at one point).
TangentFrame tangent_frame(const Vec3f& normal, const Vec3f& dp_du, const Vec3f& dp_dv,
                           const Vec2f& along_u, const Vec2f& along_v) {
    TangentFrame frame;
    const float determinant = along_u.x * along_v.y - along_u.y * along_v.x;
    if (determinant == 0.0f) return frame;
    const float sign = determinant < 0.0f ? -1.0f : 1.0f;
    const Vec3f dp_ds = (dp_du * along_v.y - dp_dv * along_u.y) * sign;
    const Vec3f dp_dt = (dp_dv * along_u.x - dp_du * along_v.x) * sign;
    const Vec3f tangent = dp_ds - normal * glm::dot(normal, dp_ds);
    const float length = glm::length(tangent);
    if (length == 0.0f) return frame;
    frame.tangent = tangent / length;
    frame.bitangent = glm::cross(normal, frame.tangent);
    if (glm::dot(frame.bitangent, dp_dt) < 0.0f) frame.bitangent = -frame.bitangent;
    frame.valid = true;
    return frame;
}

void build_tangent_space(NodeBuilder& b, const VectorSource& color, const FloatSource& strength) {
    const std::string name = b.text("uv_map");
    const VectorSource uv = uv_at(b, name, Shift::None), uv_u = uv_at(b, name, Shift::U),
                       uv_v = uv_at(b, name, Shift::V), out = b.new_source<Vec3f>();
    // Since Blender 4 strength scales the map's slopes, before it blended the resulting normals.
    const bool scales_slopes = b.value("generation", 2) >= 2;
    b.add_step(
        [=](Run& run) {
            const auto colors = run.read(color), uvs = run.read(uv), us = run.read(uv_u),
                       vs = run.read(uv_v);
            const auto strengths = run.read(strength);
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const float side = points.backfacing[i] ? -1.0f : 1.0f;
                const Vec3f normal = points.normal[i] * side;  // as modelled
                const TangentFrame frame =
                    tangent_frame(normal, points.dp_du[i], points.dp_dv[i], Vec2f(us[i] - uvs[i]),
                                  Vec2f(vs[i] - uvs[i]));
                if (!frame.valid) {  // no UV map: Cycles leaves the normal alone
                    result[i] = points.normal[i];
                    continue;
                }
                Vec3f c = 2.0f * (colors[i] - 0.5f);
                if (scales_slopes) {
                    const float s = std::max(strengths[i], 0.0f);
                    c = {c.x * s, c.y * s, 1.0f + (c.z - 1.0f) * std::min(s, 1.0f)};
                }
                const Vec3f n =
                    unit_or(frame.tangent * c.x + frame.bitangent * c.y + normal * c.z, normal);
                result[i] =
                    strengthened(points.normal[i], side * n, scales_slopes ? 1.0f : strengths[i]);
            }
        },
        {color.slot, strength.slot, uv.slot, uv_u.slot, uv_v.slot}, {out.slot});
    b.output_vector("Normal", out);
}

}  // namespace

void build_normal_map(NodeBuilder& b) {
    const VectorSource color = b.color("Color", Vec3f(0.5f, 0.5f, 1.0f));
    const FloatSource strength = b.number("Strength", 1.0f);
    const std::string space = b.text("space", "TANGENT");
    if (b.is_world()) {
        b.output_vector("Normal", b.shading_normal());
        return;
    }
    if (space == "TANGENT") {
        build_tangent_space(b, color, strength);
        return;
    }
    const bool object = space == "OBJECT" || space == "BLENDER_OBJECT";
    const bool flipped = space == "BLENDER_OBJECT" || space == "BLENDER_WORLD";
    const VectorSource out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const auto colors = run.read(color);
            const auto strengths = run.read(strength);
            const ShadingPoints& points = *run.input().points;
            const Mat3f world_normal_from_object = glm::transpose(run.input().object_from_world);
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                Vec3f n = 2.0f * (colors[i] - 0.5f);
                // Blender's own bakes have y and z turned.
                if (flipped) n = {n.x, -n.y, -n.z};
                if (object) n = world_normal_from_object * n;
                n = unit_or(n, points.normal[i]);
                if (points.backfacing[i]) n = -n;
                result[i] = strengthened(points.normal[i], n, strengths[i]);
            }
        },
        {color.slot, strength.slot}, {out.slot});
    b.output_vector("Normal", out);
}

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
                const Vec3f bumped = unit_or(std::abs(determinant) * n - scale * gradient, n);
                const float s = std::max(strengths[i], 0.0f);
                result[i] = unit_or(s * bumped + (1.0f - s) * n, n);
            }
        },
        {base.slot, height.slot, height_u.slot, height_v.slot, strength.slot, distance.slot},
        {out.slot});
    b.output_vector("Normal", out);
}

}  // namespace granita
