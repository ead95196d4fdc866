// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/tangent.h"

#include "shade/nodes/coordinates.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

Vec3f unit(const Vec3f& v) {
    const float length = glm::length(v);
    return length > 0.0f ? v / length : Vec3f(0.0f);
}

/// A quarter turn about the axis of the way from it to `generated`.
Vec3f around(RadialAxis axis, const Vec3f& generated) {
    const Vec3f r = generated - 0.5f;
    if (axis == RadialAxis::X) return {0.0f, -r.z, r.y};
    if (axis == RadialAxis::Y) return {-r.z, 0.0f, r.x};
    return {-r.y, r.x, 0.0f};
}

}  // namespace

VectorSource radial_tangent(NodeBuilder& b, RadialAxis axis) {
    const VectorSource generated = generated_at(b, b.shift()), normal = b.shading_normal();
    const VectorSource out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const auto places = run.read(generated), normals = run.read(normal);
            // As Cycles does, though it is a direction: by the matrix of normals.
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                const Vec3f n = normals[i];
                const Vec3f way = unit(run.input().axes_at(i).world_normal_from_object() *
                                       around(axis, places[i]));
                result[i] = glm::cross(n, unit(glm::cross(way, n)));
            }
        },
        {generated.slot, normal.slot}, {out.slot});
    return out;
}

void build_tangent(NodeBuilder& b) {
    if (b.is_world()) {
        b.output_vector("Tangent", {-1, Vec3f(0.0f)});
        return;
    }
    if (b.text("direction_type", "RADIAL") == "RADIAL") {
        const std::string axis = b.text("axis", "Z");
        b.output_vector("Tangent", radial_tangent(b, axis == "X"   ? RadialAxis::X
                                                     : axis == "Y" ? RadialAxis::Y
                                                                   : RadialAxis::Z));
        return;
    }
    b.output_vector("Tangent", uv_tangent(b, b.text("uv_map")));
}

}  // namespace granita
