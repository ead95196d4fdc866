// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shadow_transparency.h"

#include "dice/corner_values.h"
#include "shade/shading_points.h"

namespace granita {
namespace {

void mesh_value(const ShadowHit& hit, const AttributeRequest& request, std::vector<float>& out) {
    const CornerWeights weights(hit.patch->kind, hit.uv);
    const CornerValues corners = corner_values(*hit.geometry, *hit.patch, request);
    for (std::size_t c = 0; c < out.size(); ++c) {
        double value = 0.0;
        for (std::size_t i = 0; i < 4; ++i) value += weights.w[i] * corners.at[i][c];
        out[c] = static_cast<float>(value);
    }
}

/// The attributes that the material asks for, as a grid of one vertex holds them.
std::vector<GridAttribute> attributes_at(const ShadowHit& hit,
                                         const std::vector<AttributeRequest>& requests) {
    std::vector<GridAttribute> attributes;
    for (std::size_t k = 0; k < requests.size(); ++k) {
        GridAttribute attribute{static_cast<int>(k), requests[k].width, {}, {}, {}};
        const auto width = static_cast<std::size_t>(requests[k].width);
        attribute.values.resize(width);
        if (hit.elements)
            element_value(*hit.elements, requests[k], hit.place, attribute.values.data());
        else
            mesh_value(hit, requests[k], attribute.values);
        if (requests[k].derivatives) attribute.du = attribute.dv = std::vector<float>(width, 0.0f);
        attributes.push_back(std::move(attribute));
    }
    return attributes;
}

/// The hit as a point that is seen from where the ray started.
ShadingPoints point_at(const ShadowHit& hit) {
    const bool back = glm::dot(hit.normal, hit.direction) > 0.0f;
    const Vec3f normal = back ? -hit.normal : hit.normal;
    ShadingPoints points;
    points.count = 1;
    points.p = {hit.p};
    points.normal = points.geometric_normal = {normal};
    points.view = {-hit.direction};
    points.dp_du = points.dp_dv = {Vec3f(0.0f)};
    points.backfacing = {static_cast<std::uint8_t>(back)};
    return points;
}

}  // namespace

Vec3f shadow_transparency(const CompiledSurface& material, const Scene& scene,
                          const ShadowHit& hit) {
    const auto clamped = [](const Vec3f& c) { return glm::clamp(c, Vec3f(0.0f), Vec3f(1.0f)); };
    if (material.transparency.is_constant()) return clamped(material.transparency.constant);
    const ShadingPoints points = point_at(hit);
    const std::vector<GridAttribute> attributes = attributes_at(hit, material.requests);
    ShadingInput input;
    input.points = &points;
    input.attributes = &attributes;
    input.instance = &scene.instances[hit.instance];
    const Mat3d world_from_object(matrix_at(input.instance->world_from_object, hit.time));
    input.world_from_object = Mat3f(world_from_object);
    input.object_from_world = Mat3f(glm::inverse(world_from_object));
    Run run = material.opacity_program.prepare(input, 1);
    material.opacity_program.execute(run);
    return clamped(run.read(material.transparency)[0]);
}

}  // namespace granita
