// SPDX-License-Identifier: GPL-3.0-or-later
// What building (ray_scene_build.cpp) and tracing (ray_scene.cpp) share.
#pragma once

#include <embree3/rtcore.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "shade/rays/instance_motion.h"
#include "shade/rays/ray_detail.h"
#include "shade/rays/ray_scene.h"
#include "shade/rays/ray_transforms.h"

namespace granita {

/// What an instance tells a ray.
struct RayInstance {
    std::uint32_t index = 0;  ///< in Scene::instances
    float scale = 1.0f;       ///< largest stretch of the transform at any knot
    float distance = 0.0f;    ///< of its origin at any knot from that of shading space, metres
    bool lets_light_through = false;
    bool of_points = false;
    bool is_plain = false;  ///< hides, everywhere and throughout, and casts shadows of all lights
    /// What passes, where it is the same all over.
    std::optional<Vec3f> constant = {};
    /// Of what lets light through and stands still.
    std::optional<RayFrame> still = {};
};

struct ShadowContext;

/// Where a ray passes a surface that bounds a volume, or is of one piece with what bounds it.
struct VolumeCrossing {
    float distance;
    std::uint32_t instance;  ///< in Scene::instances
    std::int32_t material;   ///< whose volume it is
    bool bounds;
    bool enters;
};

/// Of rays that look for what is nearest, or for all that bounds volumes.
struct MetContext {
    RTCIntersectContext embree;  // first: Embree hands a pointer to it back
    const void* scene = nullptr;
    const Ray* rays = nullptr;                         ///< by their ids
    std::vector<VolumeCrossing>* crossings = nullptr;  ///< where volumes are asked for
};

struct RayScene::Impl {
    Impl(const Scene& frame_scene, RayMaterials ray_materials,
         std::shared_ptr<GeometryCache> shared, std::shared_ptr<PersistentRays> persistent_rays,
         const Displacement* moved, const Vec3d& camera)
        : scene(frame_scene),
          materials(std::move(ray_materials)),
          cache(shared ? std::move(shared) : std::make_shared<GeometryCache>()),
          kept(std::move(persistent_rays)),
          displacement(moved),
          origin(camera) {}

    RayDetail detail_of(int geometry, const SharedGeometry* shared) const;
    void make_shape(PersistentRayShape& made, const std::shared_ptr<const SharedGeometry>& shared,
                    const RayDetail& detail, const Progress& progress) const;
    void build(PersistentRayShape& made, const Progress& progress) const;
    void build_displaced(std::size_t instance, std::uint8_t use, Report& report,
                         const Progress& progress);
    bool is_displaced(std::size_t instance) const {
        return displacement && displacement->displaces(instance);
    }
    /// What stands for an instance.
    const PersistentRayShape& shape_of(std::size_t instance) const {
        if (is_displaced(instance)) return *displaced.at(displacement->same_as(instance));
        return *shapes[static_cast<std::size_t>(scene.instances[instance].geometry)];
    }
    void build_geometry(int geometry, std::uint8_t use, Report& report, const Progress& progress);
    void add_instance(std::uint32_t index, const Vec3d& origin);
    bool is_met(const Instance& instance) const {
        if (materials.is_volume_alone(instance)) return false;
        const bool any_looks = scene.options.bounces.most > 0 || scene.world.lights_scene;
        return (instance.casts_shadow || (any_looks && instance.is_seen_by_light()) ||
                materials.shines(instance) || materials.meets_itself(instance)) &&
               !instance.lifespan.is_empty();
    }
    bool holds_volume(const Instance& instance) const {
        return !instance.lifespan.is_empty() && materials.holds_volume(instance);
    }
    RTCGeometry instance_node(std::uint32_t index, const RayTransforms& transforms) const;
    void add_volumes();
    /// [faces] of a mesh of which only some bound a volume; nullptr: of others.
    const std::vector<std::int32_t>* find_enclosed(const Instance& instance);
    bool bounds_volume(std::int32_t material) const {
        return materials.inside(material) != RayMaterials::Inside::Nothing;
    }
    void note_crossing(const RTCFilterFunctionNArguments* arguments) const;
    bool lets_light_through(const Instance& instance) const;
    std::optional<Vec3f> constant_of(const Instance& instance) const;
    bool hides_itself(const ShadowContext& context, const RTCRay& ray, const RTCHit& hit,
                      const RayInstance& instance) const;
    Vec3f transparency(const ShadowContext& context, const RTCRay& ray, const RTCHit& hit,
                       const RayInstance& instance) const;
    static void pass_through(const RTCFilterFunctionNArguments* arguments);
    static void skip_absent(const RTCFilterFunctionNArguments* arguments);
    /// All but the frame and the normal.  `instance`: in Scene::instances.
    void locate(const RTCRay& traced, const RTCHit& at, std::uint32_t instance, const Vec3f& start,
                const Vec3f& direction, RayHit& hit) const;
    RayFrame frame_at(std::uint32_t instance, float time) const;
    static Vec3f normal_of(const RTCHit& at, const RayHit& hit, const RayFrame& frame);

    const Scene& scene;
    RayMaterials materials;
    std::shared_ptr<GeometryCache> cache;
    std::shared_ptr<PersistentRays> kept;  ///< nullptr = nothing casts a shadow
    const Displacement* displacement;      ///< nullptr: of none
    Vec3d origin;                          ///< of shading space
    std::vector<std::shared_ptr<const PersistentRayShape>> shapes;  ///< [geometries], as `kept`
    /// By the instance whose displacement it is.
    std::unordered_map<std::size_t, std::shared_ptr<const PersistentRayShape>> displaced;
    RtcHandle<RTCScene> top;
    InstanceMotion motion;
    std::vector<RayInstance> instances;                       ///< by Embree's id in `top`
    std::unordered_map<std::uint32_t, std::uint32_t> by_key;  ///< Instance::key to that id
    RtcHandle<RTCScene> volumes;  ///< what bounds them; nullptr: there are none
    struct VolumeInstance {
        std::uint32_t index;  ///< in Scene::instances
        /// By face, the material of the volume that its piece encloses; nullptr: all bound one.
        const std::vector<std::int32_t>* enclosed;
    };
    std::vector<VolumeInstance> volume_instances;  ///< by Embree's id there
    /// By geometry and materials.
    std::map<std::pair<int, std::vector<std::int32_t>>, std::vector<std::int32_t>> enclosed;
};

}  // namespace granita
