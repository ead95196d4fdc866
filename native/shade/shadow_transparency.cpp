// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shadow_transparency.h"

#include "geometry/surface_evaluator.h"
#include "scene/knot_time.h"

namespace granita {
namespace {

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
            hit.geometry->surface().attribute(*hit.patch, requests[k], {&hit.uv, 1},
                                              attribute.values, attribute.du, attribute.dv);
        if (requests[k].derivatives)
            attribute.du = attribute.dv = std::vector<float>(width, 0.0f);
        else
            attribute.du = attribute.dv = {};
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

/// What is no number lets nothing through, as where it is seen.
Vec3f clamped(const Vec3f& c) {
    return is_finite(c) ? glm::clamp(c, Vec3f(0.0f), Vec3f(1.0f)) : Vec3f(0.0f);
}

}  // namespace

std::optional<Vec3f> constant_transparency(const OpacityProgram& material) {
    if (!material.transparency.is_constant()) return std::nullopt;
    return clamped(material.transparency.constant);
}

Vec3f shadow_transparency(const OpacityProgram& material, const Scene& scene,
                          const ShadowHit& hit) {
    if (const auto constant = constant_transparency(material)) return *constant;
    const ShadingPoints points = point_at(hit);
    const std::vector<GridAttribute> attributes = attributes_at(hit, material.requests);
    ShadingInput input;
    input.points = &points;
    input.attributes = &attributes;
    input.instance = &scene.instances[hit.instance];
    const Mat3d world_from_object(matrix_at(input.instance->world_from_object, hit.time));
    input.world_from_object = Mat3f(world_from_object);
    input.object_from_world = Mat3f(glm::inverse(world_from_object));
    input.ray_length = hit.distance;
    Run run = material.program.prepare(input, 1);
    material.program.execute(run);
    return clamped(run.read(material.transparency)[0]);
}

}  // namespace granita
