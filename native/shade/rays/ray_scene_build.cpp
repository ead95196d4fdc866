// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>

#include "base/stage_timer.h"
#include "scene/knot_time.h"
#include "shade/rays/build_shape.h"
#include "shade/rays/ray_displaced.h"
#include "shade/rays/ray_elements.h"
#include "shade/rays/ray_mesh.h"
#include "shade/rays/ray_scene_impl.h"
#include "shade/rays/ray_subdivision.h"
#include "shade/rays/ray_transforms.h"
#include "shade/rays/ray_visibility.h"

namespace granita {
namespace {

Bounds3f box_of(RTCScene geometry) {
    RTCBounds box;
    rtcGetSceneBounds(geometry, &box);
    return {{box.lower_x, box.lower_y, box.lower_z}, {box.upper_x, box.upper_y, box.upper_z}};
}

/// How instances use a geometry; for all but the first, hits are looked at one by one.
enum Use : std::uint8_t {
    kCasts = 1,
    kLetsLightThrough = 2,
    kAppears = 4,
    kIsLinked = 8,
    kIsHidden = 16,  ///< from some rays
    kIsShaded = 32,  ///< where rays meet it
    kShines = 64,    ///< rays go to its faces
    kBounds = 128,   ///< volumes
};

}  // namespace

bool RayScene::Impl::lets_light_through(const Instance& instance) const {
    if (!materials.is_transparent) return false;
    if (instance.materials.empty()) return materials.is_transparent(-1);
    return std::any_of(instance.materials.begin(), instance.materials.end(),
                       [&](std::int32_t material) { return materials.is_transparent(material); });
}

void RayScene::Impl::make_shape(PersistentRayShape& made,
                                const std::shared_ptr<const SharedGeometry>& shared,
                                const RayDetail& detail, const Progress& progress) const {
    const RayKey& key = made.key;
    if (!shared) {
        made.shape = std::make_unique<RayElements>(
            *key.data, key.frame_time, (key.use & (kLetsLightThrough | kIsShaded)) != 0);
    } else if (!shared->subdivision()) {
        made.shape = std::make_unique<RayMesh>(shared);
    } else {
        auto shape = std::make_unique<RaySubdivision>(shared, detail, progress);
        made.is_coarsened = shape->is_coarsened();
        made.shape = std::move(shape);
    }
}

std::optional<Vec3f> RayScene::Impl::constant_of(const Instance& instance) const {
    if (!materials.constant) return std::nullopt;
    if (instance.materials.empty()) return materials.constant(-1);
    const std::optional<Vec3f> first = materials.constant(instance.materials.front());
    for (const std::int32_t material : instance.materials)
        if (materials.constant(material) != first) return std::nullopt;
    return first;
}

RayDetail RayScene::Impl::detail_of(int index, const SharedGeometry* shared) const {
    Bounds3f box;
    for (const Vec3f& p : shared->surface_points(static_cast<int>(shared->frame().knot)))
        if (is_finite(p)) box.add(p);
    return {scene, index, box};
}

void RayScene::Impl::build_geometry(int index, std::uint8_t use, Report& report,
                                    const Progress& progress) {
    const auto geometry = static_cast<std::size_t>(index);
    std::shared_ptr<const SharedGeometry> shared;
    if (scene.geometries[geometry].kind == GeometryKind::Mesh)
        shared = cache->shared(scene, geometry, report);
    const RayDetail detail =
        shared && shared->subdivision() ? detail_of(index, shared.get()) : RayDetail();
    const RayKey key{scene.geometries.share(geometry), scene.options.frame_time, use,
                     detail.eyes()};
    std::shared_ptr<const PersistentRayShape>& shape = shapes[geometry];
    shape = kept->find(key);
    if (!shape) {
        auto made = std::make_shared<PersistentRayShape>();
        made->key = key;
        make_shape(*made, shared, detail, progress);
        build(*made, progress);
        kept->add(made);
        shape = std::move(made);
    }
    if (shape->is_coarsened)
        report.warn(key.data->name,
                    "has so many faces near the camera that its shadows are coarser than a pixel");
}

void RayScene::Impl::build_displaced(std::size_t index, std::uint8_t use, Report& report,
                                     const Progress& progress) {
    const Instance& instance = scene.instances[index];
    const auto geometry = static_cast<std::size_t>(instance.geometry);
    const auto shared = cache->shared(scene, geometry, report);
    const RayDetail detail = detail_of(instance.geometry, shared.get());
    const RayKey key{scene.geometries.share(geometry),
                     scene.options.frame_time,
                     use,
                     detail.eyes(),
                     displacement->identity(),
                     index};
    std::shared_ptr<const PersistentRayShape>& shape = displaced[index];
    shape = kept->find(key);
    if (!shape) {
        auto made = std::make_shared<PersistentRayShape>();
        made->key = key;
        auto triangles =
            std::make_unique<RayDisplaced>(shared, *displacement, index, detail, progress);
        made->is_coarsened = triangles->is_coarsened();
        made->shape = std::move(triangles);
        build(*made, progress);
        kept->add(made);
        shape = std::move(made);
    }
    if (shape->is_coarsened)
        report.warn(
            instance.name,
            "is displaced so finely near the camera that its shadows are coarser than that");
}

void RayScene::Impl::build(PersistentRayShape& made, const Progress& progress) const {
    RayFilters filters;
    const bool of_points = made.key.data->kind == GeometryKind::Points;
    const bool looks_at_shadows = made.key.use & ~(kCasts | kIsShaded);
    const bool looks_at_met = made.key.use & (kAppears | kIsHidden | kBounds);
    if (of_points || looks_at_shadows) filters.occluded = pass_through;
    if (of_points || looks_at_met) filters.intersected = skip_absent;
    build_shape(made, kept->device(), filters, progress);
}

RTCGeometry RayScene::Impl::instance_node(std::uint32_t index,
                                          const RayTransforms& transforms) const {
    const auto& columns = transforms.columns;
    RTCGeometry node = rtcNewGeometry(kept->device(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(node, shape_of(index).built.get());
    rtcSetGeometryTimeStepCount(node, static_cast<unsigned>(columns.size()));
    for (unsigned k = 0; k < columns.size(); ++k)
        rtcSetGeometryTransform(node, k, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns[k].data());
    rtcCommitGeometry(node);
    return node;
}

void RayScene::Impl::add_instance(std::uint32_t index, const Vec3d& origin) {
    const Instance& instance = scene.instances[index];
    const auto transforms = ray_transforms(instance.world_from_object, origin);
    if (!transforms) return;
    RTCGeometry node = instance_node(index, *transforms);
    const PersistentRayShape& kept_shape = shape_of(index);
    if (transforms->columns.size() > 1 || kept_shape.shape->knots() > 1 ||
        !instance.lifespan.is_whole())
        motion.add(box_of(kept_shape.built.get()), transforms->knots);
    rtcAttachGeometryByID(top.get(), node, static_cast<unsigned>(instances.size()));
    rtcReleaseGeometry(node);
    by_key[instance.key] = static_cast<std::uint32_t>(instances.size());
    const bool passes = lets_light_through(instance);
    const bool is_plain =
        meets_all(instance) && !passes && instance.lifespan.is_whole() && instance.blocks == ~0ULL;
    RayInstance& added = instances.emplace_back();
    added.index = index;
    added.scale = transforms->scale;
    added.distance = transforms->distance;
    added.lets_light_through = passes;
    added.of_points = kept_shape.key.data->kind == GeometryKind::Points;
    added.is_plain = is_plain;
    added.constant = constant_of(instance);
    const bool is_asked = added.lets_light_through || scene.options.bounces.most > 0 ||
                          materials.meets_itself(instance);
    if (is_asked && instance.world_from_object.size() <= 1)
        added.still.emplace(matrix_at(instance.world_from_object, 0.0));
}

void RayScene::Impl::add_volumes() {
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        if (!holds_volume(scene.instances[i])) continue;
        const auto transforms = ray_transforms(scene.instances[i].world_from_object, origin);
        if (!transforms) continue;
        if (!volumes) {
            volumes.reset(rtcNewScene(kept->device()));
            rtcSetSceneFlags(volumes.get(), RTC_SCENE_FLAG_ROBUST);
        }
        const PersistentRayShape& shape = shape_of(i);
        if (transforms->columns.size() > 1 || shape.shape->knots() > 1 ||
            !scene.instances[i].lifespan.is_whole())
            motion.add(box_of(shape.built.get()), transforms->knots);
        RTCGeometry node = instance_node(i, *transforms);
        rtcAttachGeometryByID(volumes.get(), node, static_cast<unsigned>(volume_instances.size()));
        rtcReleaseGeometry(node);
        volume_instances.push_back({i, find_enclosed(scene.instances[i])});
    }
    if (!volumes) return;
    const ForeignThreads embree;
    rtcCommitScene(volumes.get());
}

RayScene::RayScene(const Scene& scene, const Vec3d& origin, RayMaterials materials,
                   const Progress& progress, std::shared_ptr<GeometryCache> geometries,
                   Report* report, std::shared_ptr<PersistentRays> kept,
                   const Displacement* displacement)
    : m_impl(std::make_unique<Impl>(scene, std::move(materials), std::move(geometries),
                                    std::move(kept), displacement, origin)) {
    Report unread;
    Report& warnings = report ? *report : unread;
    Impl& impl = *m_impl;
    std::vector<std::uint8_t> uses(scene.geometries.size(), 0);
    std::map<std::size_t, std::uint8_t> displaced;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (!impl.is_met(instance) && !impl.holds_volume(instance)) continue;
        std::uint8_t& use = impl.is_displaced(i)
                                ? displaced[displacement->same_as(i)]
                                : uses[static_cast<std::size_t>(instance.geometry)];
        use |= scene.options.bounces.most > 0 ? kCasts | kIsShaded : kCasts;
        if (impl.lets_light_through(instance)) use |= kLetsLightThrough;
        if (!instance.lifespan.is_whole()) use |= kAppears;
        if (instance.blocks != ~0ULL) use |= kIsLinked;
        if (impl.materials.shines(instance)) use |= kShines;
        if (impl.holds_volume(instance)) use |= kBounds;
        if (!meets_all(instance)) use |= kIsHidden;
    }
    if (displaced.empty() &&
        std::all_of(uses.begin(), uses.end(), [](std::uint8_t use) { return use == 0; }))
        return;
    if (!impl.kept) impl.kept = std::make_shared<PersistentRays>();
    impl.shapes.resize(scene.geometries.size());
    for (std::size_t g = 0; g < uses.size(); ++g) {
        progress.check();
        if (uses[g]) impl.build_geometry(static_cast<int>(g), uses[g], warnings, progress);
    }
    for (const auto& [instance, use] : displaced) {
        progress.check();
        impl.build_displaced(instance, use, warnings, progress);
    }
    impl.top.reset(rtcNewScene(impl.kept->device()));
    rtcSetSceneFlags(impl.top.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneProgressMonitorFunction(impl.top.get(), embree_goes_on,
                                       const_cast<Progress*>(&progress));
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
        if (impl.is_met(scene.instances[i])) impl.add_instance(i, origin);
    {
        const ForeignThreads embree;
        rtcCommitScene(impl.top.get());
    }
    impl.add_volumes();
    check_embree(impl.kept->device(),
                 "scene of " + std::to_string(impl.instances.size()) + " instances", progress);
    // Embree keeps the pointer; the frame's progress may die before the scene does.
    rtcSetSceneProgressMonitorFunction(impl.top.get(), nullptr, nullptr);
}

std::size_t RayScene::bytes() const {
    std::size_t sum = m_impl->kept ? m_impl->kept->embree_bytes() : 0;
    for (const auto& shape : m_impl->shapes)
        if (shape) sum += shape->shape->bytes();
    for (const auto& [instance, shape] : m_impl->displaced) sum += shape->shape->bytes();
    return sum;
}

}  // namespace granita
