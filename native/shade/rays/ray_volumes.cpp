// SPDX-License-Identifier: GPL-3.0-or-later
// Where rays are inside of things: all surfaces that bound volumes are met, front to back.  No
// state goes along with a ray: what it leaves before it has entered it has started in, so that rays
// that start anywhere, as refracted ones do, know where they are.
#include <algorithm>
#include <limits>

#include "shade/rays/enclosed_volumes.h"
#include "shade/rays/ray_scene_impl.h"
#include "shade/rays/ray_visibility.h"
#include "shade/rays/set_ray.h"

namespace granita {
namespace {

/// By instance; what is left where it is entered, as where edges are grazed, is not there.
bool is_before(const VolumeCrossing& a, const VolumeCrossing& b) {
    if (a.instance != b.instance) return a.instance < b.instance;
    if (a.distance != b.distance) return a.distance < b.distance;
    return a.enters && !b.enters;
}

}  // namespace

const std::vector<std::int32_t>* RayScene::Impl::find_enclosed(const Instance& instance) {
    const GeometryData& data = scene.geometry_of(instance);
    const auto bounds = [this](std::int32_t material) { return bounds_volume(material); };
    if (data.kind != GeometryKind::Mesh || std::ranges::all_of(instance.materials, bounds))
        return nullptr;
    auto& found = enclosed[{instance.geometry, instance.materials}];
    if (found.empty())
        found = enclosed_volumes(data, [&](std::size_t face) {
            const std::int32_t material = instance.material(data.slot(face));
            return bounds(material) ? material : -1;
        });
    return &found;
}

void RayScene::Impl::note_crossing(const RTCFilterFunctionNArguments* arguments) const {
    auto& context = *reinterpret_cast<MetContext*>(arguments->context);
    const auto& traced = *reinterpret_cast<const RTCRay*>(arguments->ray);
    const auto& at = *reinterpret_cast<const RTCHit*>(arguments->hit);
    const auto& [index, enclosed_by_face] = volume_instances[arguments->context->instID[0]];
    const Instance& instance = scene.instances[index];
    const Ray& ray = context.rays[0];
    arguments->valid[0] = 0;  // goes on
    if (!meets(ray.type, instance, ray.blocker_set) || !instance.lifespan.contains(ray.time))
        return;
    std::int32_t material = instance.materials.front();
    bool bounds = true;
    if (instance.materials.size() > 1) {
        RayHit hit;
        locate(traced, at, index, ray.start, ray.direction, hit);
        material = hit.material;
        bounds = bounds_volume(material);
        if (!bounds && enclosed_by_face)
            material = (*enclosed_by_face)[static_cast<std::size_t>(hit.patch->face)];
    }
    if (material < 0 || !bounds_volume(material)) return;
    // In the space of the object, of which both are told.
    const float side = at.Ng_x * traced.dir_x + at.Ng_y * traced.dir_y + at.Ng_z * traced.dir_z;
    context.crossings->push_back({traced.tfar, index, material, bounds, side < 0.0f});
}

void RayScene::volumes(const Ray& ray, std::vector<VolumeSpan>& out) const {
    out.clear();
    if (!m_impl->volumes || !ray.is_traceable()) return;
    static thread_local std::vector<VolumeCrossing> crossings;
    crossings.clear();
    MetContext context{};
    rtcInitIntersectContext(&context.embree);
    context.scene = m_impl.get();
    context.rays = &ray;
    context.crossings = &crossings;
    RTCRayHit traced{};
    set_ray(traced.ray, ray);
    traced.ray.tfar = std::numeric_limits<float>::infinity();  // what it ends in is left beyond it
    traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(m_impl->volumes.get(), &context.embree, &traced);
    if (crossings.empty()) return;
    std::ranges::sort(crossings, is_before);
    for (std::size_t i = 0, end; i < crossings.size(); i = end) {
        for (end = i; end < crossings.size() && crossings[end].instance == crossings[i].instance;)
            ++end;
        bool inside = !crossings[i].enters;
        VolumeSpan span{crossings[i].instance, crossings[i].material, 0.0f, ray.distance};
        for (std::size_t k = i; k < end && crossings[k].distance < ray.distance; ++k) {
            if (crossings[k].enters == inside) continue;  // met twice, as at an edge
            if (!crossings[k].bounds) continue;           // nobody comes in or out here
            if (inside) {
                span.end = crossings[k].distance;
                out.push_back(span);
            } else {
                span = {crossings[k].instance, crossings[k].material, crossings[k].distance,
                        ray.distance};
            }
            inside = !inside;
        }
        span.end = ray.distance;
        if (inside) out.push_back(span);
    }
}

}  // namespace granita
