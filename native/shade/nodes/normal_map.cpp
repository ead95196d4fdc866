// SPDX-License-Identifier: GPL-3.0-or-later
// Normal Map: shading normals out of images.
#include <algorithm>
#include <cmath>

#include "math/normalize_or.h"
#include "shade/nodes/coordinates.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

/// From the surface's normal to the map's and, above 1, beyond it.
Vec3f strengthened(const Vec3f& normal, const Vec3f& mapped, float strength) {
    return normalize_or(normal + (mapped - normal) * std::max(strength, 0.0f), normal);
}

struct TangentFrame {
    Vec3f normal{0.0f}, tangent{0.0f}, bitangent{0.0f};
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
    frame.normal = normal;
    frame.tangent = tangent / length;
    frame.bitangent = glm::cross(normal, frame.tangent);
    if (glm::dot(frame.bitangent, dp_dt) < 0.0f) frame.bitangent = -frame.bitangent;
    frame.valid = true;
    return frame;
}

/// Polygons have tangents at their corners, which are interpolated as normals are and, as in
/// Cycles, not made unit again; since Blender 5.1 the normals are.  On a subdivision surface the
/// map's own derivatives are what the corners' tangents tend to as it is refined.
void build_tangent_space(NodeBuilder& b, const VectorSource& color, const FloatSource& strength) {
    const std::string name = b.text("uv_map");
    const AttributeRequest of_corners{AttributeSource::Tangent, name, 4};
    const VectorSource tangent = b.attribute_at(of_corners, Shift::None),
                       corner_normal =
                           b.attribute_at({AttributeSource::CornerNormal, "", 3}, Shift::None),
                       uv = uv_at(b, name, Shift::None), uv_u = uv_beside(b, name, Shift::U),
                       uv_v = uv_beside(b, name, Shift::V), out = b.new_source<Vec3f>();
    const FloatSource sign = b.attribute_component(of_corners, 3, Shift::None);
    // Of what is displaced Blender 5 takes the normals as modelled, unless nothing bends them;
    // since 5.1 the artist chooses.
    const bool is_moved = b.has_moved_normals(),
               takes_modelled = b.since(5, 0) && b.text("base") != "DISPLACED";
    // Since Blender 4 strength scales the map's slopes, before it blended the resulting normals, as
    // it does again between the displaced surface's and those of a map on the modelled one.
    const bool scales_slopes = b.since(4, 0) && !(b.moves_surface() && takes_modelled);
    const bool has_unit_normals = b.since(5, 1);
    const VectorSource shown = b.shading_normal();
    b.add_step(
        [=](Run& run) {
            const auto colors = run.read(color), uvs = run.read(uv), us = run.read(uv_u),
                       vs = run.read(uv_v), tangents = run.read(tangent),
                       corner_normals = run.read(corner_normal), unbent = run.read(shown);
            const auto strengths = run.read(strength), signs = run.read(sign);
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const float side = points.backfacing[i] ? -1.0f : 1.0f;
                const Vec3f normal = points.normal[i] * side;  // as modelled
                const bool has_tangent = tangents[i] != Vec3f(0.0f);
                TangentFrame frame;
                if (has_tangent) {
                    const ObjectAxes& axes = run.input().axes_at(i);
                    const Vec3f smooth = is_moved && (!takes_modelled || !(strengths[i] > 0.0f))
                                             ? axes.object_normal_of(normal)
                                             : corner_normals[i];
                    const Vec3f up = has_unit_normals ? normalize_or(smooth, smooth) : smooth;
                    frame = {up, tangents[i], signs[i] * glm::cross(up, tangents[i]), true};
                } else {
                    frame = tangent_frame(normal, points.dp_du[i], points.dp_dv[i],
                                          Vec2f(us[i] - uvs[i]), Vec2f(vs[i] - uvs[i]));
                }
                if (!frame.valid) {  // no UV map: Cycles leaves the normal alone
                    result[i] = unbent[i];
                    continue;
                }
                Vec3f c = 2.0f * (colors[i] - 0.5f);
                if (scales_slopes) {
                    const float s = std::max(strengths[i], 0.0f);
                    c = {c.x * s, c.y * s, 1.0f + (c.z - 1.0f) * std::min(s, 1.0f)};
                }
                Vec3f n = frame.tangent * c.x + frame.bitangent * c.y + frame.normal * c.z;
                if (has_tangent) n = run.input().axes_at(i).world_normal_from_object() * n;
                n = normalize_or(n, normal);
                result[i] = strengthened(unbent[i], side * n, scales_slopes ? 1.0f : strengths[i]);
            }
        },
        {color.slot, strength.slot, shown.slot, uv.slot, uv_u.slot, uv_v.slot, tangent.slot,
         sign.slot, corner_normal.slot},
        {out.slot});
    b.output_vector("Normal", out);
}

}  // namespace

VectorSource uv_tangent(NodeBuilder& b, const std::string& name) {
    const VectorSource of_corners =
        b.attribute_at({AttributeSource::Tangent, name, 4}, Shift::None);
    const VectorSource uv = uv_at(b, name, Shift::None), uv_u = uv_beside(b, name, Shift::U),
                       uv_v = uv_beside(b, name, Shift::V), shown = b.shading_normal(),
                       out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const auto uvs = run.read(uv), us = run.read(uv_u), vs = run.read(uv_v),
                       tangents = run.read(of_corners), normals = run.read(shown);
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                Vec3f along = run.input().axes_at(i).world_normal_from_object() * tangents[i];
                if (tangents[i] == Vec3f(0.0f)) {
                    const TangentFrame frame =
                        tangent_frame(points.normal[i], points.dp_du[i], points.dp_dv[i],
                                      Vec2f(us[i] - uvs[i]), Vec2f(vs[i] - uvs[i]));
                    along = frame.valid ? frame.tangent : points.dp_du[i];
                }
                const Vec3f normal = normals[i];
                result[i] = normalize_or(along - normal * glm::dot(normal, along), Vec3f(0.0f));
            }
        },
        {of_corners.slot, uv.slot, uv_u.slot, uv_v.slot, shown.slot}, {out.slot});
    return out;
}

void build_normal_map(NodeBuilder& b) {
    VectorSource color = b.color("Color", Vec3f(0.5f, 0.5f, 1.0f));
    if (b.text("convention") == "DIRECTX")  // green is down
        color = b.map<Vec3f>([](const Vec3f& c) { return Vec3f(c.x, 1.0f - c.y, c.z); }, color);
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
    const VectorSource shown = b.shading_normal(), out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const auto colors = run.read(color), unbent = run.read(shown);
            const auto strengths = run.read(strength);
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                Vec3f n = 2.0f * (colors[i] - 0.5f);
                // Blender's own bakes have y and z turned.
                if (flipped) n = {n.x, -n.y, -n.z};
                if (object) n = run.input().axes_at(i).world_normal_from_object() * n;
                n = normalize_or(n, points.normal[i]);
                if (points.backfacing[i]) n = -n;
                result[i] = strengthened(unbent[i], n, strengths[i]);
            }
        },
        {color.slot, strength.slot, shown.slot}, {out.slot});
    b.output_vector("Normal", out);
}

}  // namespace granita
