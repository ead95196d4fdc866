// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shadow_transparency.h"

#include <memory>
#include <utility>

#include "base/object_pool.h"
#include "shade/rays/hit_attributes.h"

namespace granita {
namespace {

/// What one hit needs; a frame has tens of millions of them.
struct Scratch {
    ShadingPoints points;
    HitAttributes attributes;
    std::vector<float> memory;  ///< of the run
};

/// The hit as a point that is seen from where the ray started.
void fill_point(const RayHit& hit, ShadingPoints& points) {
    const bool back = glm::dot(hit.normal, hit.direction) > 0.0f;
    const Vec3f normal = back ? -hit.normal : hit.normal;
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

std::optional<Vec3f> constant_transparency(const OpacityProgram& material) {
    if (!material.transparency.is_constant()) return std::nullopt;
    return clamped(material.transparency.constant);
}

Vec3f shadow_transparency(const OpacityProgram& material, const Scene& scene, const RayHit& hit) {
    if (const auto constant = constant_transparency(material)) return *constant;
    auto scratch = ObjectPool<std::unique_ptr<Scratch>>::take();
    if (!scratch) scratch = std::make_unique<Scratch>();
    scratch->points.count = 1;
    if (!material.is_painted) fill_point(hit, scratch->points);
    scratch->attributes.resize(material.requests, 1);
    scratch->attributes.fill(0, hit, material.requests);
    ShadingInput input;
    input.points = &scratch->points;
    input.attributes = &scratch->attributes.grid();
    input.instance = &scene.instances[hit.instance];
    if (!material.is_painted) {
        input.axes.world_from_object = hit.frame->world_from_object;
        input.axes.object_from_world = hit.frame->object_from_world;
    }
    input.ray_length = hit.distance;
    Run run = material.program.prepare(input, 1, std::move(scratch->memory));
    material.program.execute(run);
    const Vec3f passed = clamped(run.read(material.transparency)[0]);
    scratch->memory = run.take_memory();
    ObjectPool<std::unique_ptr<Scratch>>::give(std::move(scratch));
    return passed;
}

}  // namespace

void tell_transparency(
    RayMaterials& asked, const Scene& scene,
    const std::function<const CompiledSurface&(std::int32_t material)>& surface,
    std::function<const OpacityProgram&(std::int32_t material, RayType ray)> opacity) {
    asked.is_transparent = [surface](std::int32_t index) {
        return surface(index).is_told_apart || !surface(index).shadow.transparency.is(Vec3f(0.0f));
    };
    asked.constant = [surface](std::int32_t index) {
        return surface(index).is_told_apart ? std::nullopt
                                            : constant_transparency(surface(index).shadow);
    };
    asked.is_painted = [opacity](std::int32_t index, RayType ray) {
        return opacity(index, ray).is_painted;
    };
    asked.transparency = [opacity = std::move(opacity), &scene](const RayHit& hit, RayType ray) {
        return shadow_transparency(opacity(hit.material, ray), scene, hit);
    };
}

}  // namespace granita
