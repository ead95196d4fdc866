// SPDX-License-Identifier: GPL-3.0-or-later
// Displacement and Vector Displacement: where a point goes, world axes.
#include <cmath>

#include "math/normalize_or.h"
#include "shade/nodes/coordinates.h"
#include "shade/nodes/nodes.h"

namespace granita {
namespace {

/// UV maps' tangents at the corners of polygons, as a Normal Map reads them; where there are none,
/// along growing u of the map, or of the surface.
struct TangentSources {
    VectorSource of_corners;
    FloatSource sign;
    VectorSource uv, uv_u, uv_v;
};

struct Tangents {
    Vec3f along, across;
};

Tangents tangents(const ObjectAxes& axes, const Vec3f& normal, const Vec3f& of_corners, float sign,
                  const Vec3f& dp_du, const Vec3f& dp_dv, const Vec2f& by_u, const Vec2f& by_v) {
    if (of_corners != Vec3f(0.0f)) {
        const Vec3f along = normalize_or(of_corners, of_corners);
        return {along, sign * normalize_or(glm::cross(normal, along), Vec3f(0.0f))};
    }
    const float determinant = by_u.x * by_v.y - by_u.y * by_v.x;
    const Vec3f u = axes.object_from_world * dp_du, v = axes.object_from_world * dp_dv;
    const float side = determinant < 0.0f ? -1.0f : 1.0f;
    Vec3f along = u;
    if (determinant != 0.0f) along = (u * by_v.y - v * by_u.y) * side;
    along = normalize_or(along - normal * glm::dot(normal, along), Vec3f(0.0f));
    // At a patch's far sides steps go back: then they turn the other way about the normal.
    const float turn = glm::dot(glm::cross(u, v), normal) < 0.0f ? -1.0f : 1.0f;
    return {along, side * turn * glm::cross(normal, along)};
}

}  // namespace

void build_displacement(NodeBuilder& b) {
    const bool in_object = b.text("space", "OBJECT") == "OBJECT";
    const VectorSource normal = b.normal_input(), out = b.new_source<Vec3f>();
    const FloatSource height = b.number("Height"), midlevel = b.number("Midlevel", 0.5f),
                      scale = b.number("Scale", 1.0f);
    b.add_step(
        [=](Run& run) {
            const auto normals = run.read(normal);
            const auto heights = run.read(height), levels = run.read(midlevel),
                       scales = run.read(scale);
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const float amount = (heights[i] - levels[i]) * scales[i];
                const ObjectAxes& axes = run.input().axes_at(i);
                result[i] = in_object ? axes.world_from_object *
                                            (amount * axes.object_normal_of(normals[i]))
                                      : amount * normals[i];
            }
        },
        {normal.slot, height.slot, midlevel.slot, scale.slot}, {out.slot});
    b.output_vector("Displacement", out);
}

void build_vector_displacement(NodeBuilder& b) {
    const std::string space = b.text("space", "TANGENT");
    const bool tangent = space == "TANGENT", in_world = space == "WORLD";
    const VectorSource vector = b.vector("Vector"), out = b.new_source<Vec3f>();
    const FloatSource midlevel = b.number("Midlevel", 0.0f), scale = b.number("Scale", 1.0f);
    TangentSources from;
    if (tangent) {
        const AttributeRequest of_corners{AttributeSource::Tangent, "", 4};
        from.of_corners = b.attribute_at(of_corners, Shift::None);
        from.sign = b.attribute_component(of_corners, 3, Shift::None);
        from.uv = uv_at(b, "", Shift::None);
        from.uv_u = uv_beside(b, "", Shift::U);
        from.uv_v = uv_beside(b, "", Shift::V);
    }
    b.add_step(
        [=](Run& run) {
            const auto vectors = run.read(vector), corners = run.read(from.of_corners),
                       uvs = run.read(from.uv), us = run.read(from.uv_u), vs = run.read(from.uv_v);
            const auto levels = run.read(midlevel), scales = run.read(scale),
                       signs = run.read(from.sign);
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                Vec3f way = (vectors[i] - levels[i]) * scales[i];
                const ObjectAxes& axes = run.input().axes_at(i);
                if (tangent) {
                    const Vec3f n = axes.object_normal_of(points.normal[i]);
                    const Tangents t =
                        tangents(axes, n, corners[i], signs[i], points.dp_du[i], points.dp_dv[i],
                                 Vec2f(us[i] - uvs[i]), Vec2f(vs[i] - uvs[i]));
                    way = t.along * way.x + n * way.y + t.across * way.z;
                }
                result[i] = in_world ? way : axes.world_from_object * way;
            }
        },
        {vector.slot, midlevel.slot, scale.slot, from.of_corners.slot, from.sign.slot, from.uv.slot,
         from.uv_u.slot, from.uv_v.slot},
        {out.slot});
    b.output_vector("Displacement", out);
}

}  // namespace granita
