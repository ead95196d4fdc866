// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shadow_transparency.h"

#include <memory>
#include <utility>

#include "base/object_pool.h"
#include "geometry/surface_evaluator.h"

namespace granita {
namespace {

/// What one hit needs; a frame has tens of millions of them.
struct Scratch {
    ShadingPoints points;
    std::vector<GridAttribute> attributes;
    std::vector<float> memory;  ///< of the run
};

/// The attributes that the material asks for, as a grid of one vertex holds them.
void fill_attributes(const RayHit& hit, const std::vector<AttributeRequest>& requests,
                     std::vector<GridAttribute>& attributes) {
    attributes.resize(requests.size());
    for (std::size_t k = 0; k < requests.size(); ++k) {
        GridAttribute& attribute = attributes[k];
        attribute.attribute = static_cast<int>(k);
        attribute.width = requests[k].width;
        const auto width = static_cast<std::size_t>(requests[k].width);
        attribute.values.resize(width);
        if (hit.elements)
            element_value(*hit.elements, requests[k], hit.place, attribute.values.data());
        else
            hit.geometry->surface().attribute(*hit.patch, requests[k], {&hit.uv, 1},
                                              attribute.values, attribute.du, attribute.dv);
        const std::size_t derivatives = requests[k].derivatives ? width : 0;
        attribute.du.assign(derivatives, 0.0f);
        attribute.dv.assign(derivatives, 0.0f);
    }
}

/// The hit as a point that is seen from where the ray started.
void fill_point(const RayHit& hit, ShadingPoints& points) {
    const bool back = glm::dot(hit.normal, hit.direction) > 0.0f;
    const Vec3f normal = back ? -hit.normal : hit.normal;
    points.count = 1;
    points.p.assign(1, hit.p);
    points.normal.assign(1, normal);
    points.geometric_normal.assign(1, normal);
    points.view.assign(1, -hit.direction);
    points.dp_du.assign(1, Vec3f(0.0f));
    points.dp_dv.assign(1, Vec3f(0.0f));
    points.backfacing.assign(1, back);
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

Vec3f shadow_transparency(const OpacityProgram& material, const Scene& scene, const RayHit& hit) {
    if (const auto constant = constant_transparency(material)) return *constant;
    auto scratch = ObjectPool<std::unique_ptr<Scratch>>::take();
    if (!scratch) scratch = std::make_unique<Scratch>();
    fill_point(hit, scratch->points);
    fill_attributes(hit, material.requests, scratch->attributes);
    ShadingInput input;
    input.points = &scratch->points;
    input.attributes = &scratch->attributes;
    input.instance = &scene.instances[hit.instance];
    input.axes.world_from_object = hit.frame->world_from_object;
    input.axes.object_from_world = hit.frame->object_from_world;
    input.ray_length = hit.distance;
    Run run = material.program.prepare(input, 1, std::move(scratch->memory));
    material.program.execute(run);
    const Vec3f passed = clamped(run.read(material.transparency)[0]);
    scratch->memory = run.take_memory();
    ObjectPool<std::unique_ptr<Scratch>>::give(std::move(scratch));
    return passed;
}

}  // namespace granita
