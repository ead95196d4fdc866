// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>

#include "base/stage_timer.h"
#include "math/normalize_or.h"
#include "scene/knot_time.h"
#include "shade/rays/covering_triangle.h"
#include "shade/rays/instance_motion.h"
#include "shade/rays/ray_detail.h"
#include "shade/rays/ray_displaced.h"
#include "shade/rays/ray_elements.h"
#include "shade/rays/ray_mesh.h"
#include "shade/rays/ray_subdivision.h"
#include "shade/rays/ray_transforms.h"

namespace granita {
namespace {

bool goes_on(void* user, double) {
    return !static_cast<const Progress*>(user)->cancelled();
}

/// Rays traced at once.
constexpr std::size_t kPacket = 16;

Bounds3f box_of(RTCScene geometry) {
    RTCBounds box;
    rtcGetSceneBounds(geometry, &box);
    return {{box.lower_x, box.lower_y, box.lower_z}, {box.upper_x, box.upper_y, box.upper_z}};
}

/// How instances use a geometry; for all but the first, hits are looked at one by one.
enum Use : std::uint8_t { kCasts = 1, kLetsLightThrough = 2, kAppears = 4, kIsLinked = 8 };

/// What an instance tells a ray.
struct RayInstance {
    std::uint32_t index = 0;  ///< in Scene::instances
    float scale = 1.0f;       ///< largest stretch of the transform at any knot
    float distance = 0.0f;    ///< of its origin at any knot from that of shading space, metres
    bool lets_light_through = false;
    /// What passes, where it is the same all over.
    std::optional<Vec3f> constant = {};
    /// Of what lets light through and stands still.
    std::optional<ShadowFrame> still = {};
};

/// A ray and what is left of its light.
struct ShadowContext {
    RTCIntersectContext embree;  // first: Embree hands a pointer to it back
    /// Of rays traced together, [their numbers], those that meet something that may let light
    /// through: it stops them, and they are traced again by themselves.  nullptr: one ray.
    bool* looked_at = nullptr;
    const void* scene = nullptr;
    Vec3f start, direction;  ///< shading space: what Embree hands back is in the object's
    Vec3f left{1.0f};
    int blocker_set = -1;
    std::exception_ptr failure;
};

}  // namespace

struct RayScene::Impl {
    Impl(const Scene& frame_scene, ShadowOpacity shadow_opacity,
         std::shared_ptr<GeometryCache> shared, std::shared_ptr<KeptRays> kept_rays,
         const Displacement* moved, const Vec3d& camera)
        : scene(frame_scene),
          opacity(std::move(shadow_opacity)),
          cache(shared ? std::move(shared) : std::make_shared<GeometryCache>()),
          kept(std::move(kept_rays)),
          displacement(moved),
          origin(camera) {}

    void check(const std::string& what, const Progress& progress) const;
    RayDetail detail_of(int geometry, const SharedGeometry* shared) const;
    void make_shape(KeptRayShape& made, const std::shared_ptr<const SharedGeometry>& shared,
                    const RayDetail& detail, const Progress& progress) const;
    void build(KeptRayShape& made, const Progress& progress) const;
    void build_displaced(std::size_t instance, std::uint8_t use, Report& report,
                         const Progress& progress);
    bool is_displaced(std::size_t instance) const {
        return displacement && displacement->displaces(instance);
    }
    /// What stands for an instance.
    const KeptRayShape& shape_of(std::size_t instance) const {
        if (is_displaced(instance)) return *displaced.at(displacement->same_as(instance));
        return *shapes[static_cast<std::size_t>(scene.instances[instance].geometry)];
    }
    void build_geometry(int geometry, std::uint8_t use, Report& report, const Progress& progress);
    void add_instance(std::uint32_t index, const Vec3d& origin);
    static bool casts_shadow(const Instance& instance) {
        return instance.casts_shadow && !instance.lifespan.is_empty();
    }
    bool lets_light_through(const Instance& instance) const;
    std::optional<Vec3f> constant_of(const Instance& instance) const;
    Vec3f transparency(const ShadowContext& context, const RTCRay& ray, const RTCHit& hit,
                       const RayInstance& instance) const;
    static void pass_through(const RTCFilterFunctionNArguments* arguments);

    const Scene& scene;
    ShadowOpacity opacity;
    std::shared_ptr<GeometryCache> cache;
    std::shared_ptr<KeptRays> kept;                           ///< nullptr = nothing casts a shadow
    const Displacement* displacement;                         ///< nullptr: of none
    Vec3d origin;                                             ///< of shading space
    std::vector<std::shared_ptr<const KeptRayShape>> shapes;  ///< [geometries], as `kept`
    /// By the instance whose displacement it is.
    std::unordered_map<std::size_t, std::shared_ptr<const KeptRayShape>> displaced;
    RtcHandle<RTCScene> top;
    InstanceMotion motion;
    std::vector<RayInstance> instances;                       ///< by Embree's id in `top`
    std::unordered_map<std::uint32_t, std::uint32_t> by_key;  ///< Instance::key to that id
};

void RayScene::Impl::check(const std::string& what, const Progress& progress) const {
    progress.check();
    const RTCError error = rtcGetDeviceError(kept->device());
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw SceneError(what, "not enough memory for its shadow rays");
    throw SceneError(what, "Embree failed with error " + std::to_string(error));
}

bool RayScene::Impl::lets_light_through(const Instance& instance) const {
    if (!opacity.is_transparent) return false;
    if (instance.materials.empty()) return opacity.is_transparent(-1);
    return std::any_of(instance.materials.begin(), instance.materials.end(),
                       [&](std::int32_t material) { return opacity.is_transparent(material); });
}

void RayScene::Impl::make_shape(KeptRayShape& made,
                                const std::shared_ptr<const SharedGeometry>& shared,
                                const RayDetail& detail, const Progress& progress) const {
    const RayKey& key = made.key;
    if (!shared) {
        made.shape = std::make_unique<RayElements>(*key.data, key.frame_time,
                                                   (key.use & kLetsLightThrough) != 0);
    } else if (!shared->subdivision()) {
        made.shape = std::make_unique<RayMesh>(shared);
    } else {
        auto shape = std::make_unique<RaySubdivision>(shared, detail, progress);
        made.is_coarsened = shape->is_coarsened();
        made.shape = std::move(shape);
    }
}

std::optional<Vec3f> RayScene::Impl::constant_of(const Instance& instance) const {
    if (!opacity.constant) return std::nullopt;
    if (instance.materials.empty()) return opacity.constant(-1);
    const std::optional<Vec3f> first = opacity.constant(instance.materials.front());
    for (const std::int32_t material : instance.materials)
        if (opacity.constant(material) != first) return std::nullopt;
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
    std::shared_ptr<const KeptRayShape>& shape = shapes[geometry];
    shape = kept->find(key);
    if (!shape) {
        auto made = std::make_shared<KeptRayShape>();
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

/// Not kept for the next picture: materials may change.
void RayScene::Impl::build_displaced(std::size_t index, std::uint8_t use, Report& report,
                                     const Progress& progress) {
    const Instance& instance = scene.instances[index];
    const auto geometry = static_cast<std::size_t>(instance.geometry);
    const auto shared = cache->shared(scene, geometry, report);
    auto made = std::make_shared<KeptRayShape>();
    made->key = {scene.geometries.share(geometry), scene.options.frame_time, use, {}};
    auto shape = std::make_unique<RayDisplaced>(
        shared, *displacement, index, detail_of(instance.geometry, shared.get()), progress);
    if (shape->is_coarsened())
        report.warn(
            instance.name,
            "is displaced so finely near the camera that its shadows are coarser than that");
    made->shape = std::move(shape);
    build(*made, progress);
    displaced[index] = std::move(made);
}

void RayScene::Impl::build(KeptRayShape& made, const Progress& progress) const {
    const std::string what = made.key.data->name + " of " + made.shape->size();
    made.built.reset(rtcNewScene(kept->device()));
    RTCScene built = made.built.get();
    rtcSetSceneFlags(built, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(built, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneProgressMonitorFunction(built, goes_on, const_cast<Progress*>(&progress));
    for (RTCGeometry handed : made.shape->hand_over(kept->device())) {
        if (made.key.use & ~kCasts) rtcSetGeometryOccludedFilterFunction(handed, pass_through);
        rtcCommitGeometry(handed);
        rtcAttachGeometry(built, handed);
        rtcReleaseGeometry(handed);
    }
    {
        const ForeignThreads embree;
        rtcCommitScene(built);
    }
    check(what, progress);
    // Embree keeps the pointer, and the geometry may outlive the frame.
    rtcSetSceneProgressMonitorFunction(built, nullptr, nullptr);
}

void RayScene::Impl::add_instance(std::uint32_t index, const Vec3d& origin) {
    const Instance& instance = scene.instances[index];
    const auto transforms = ray_transforms(instance.world_from_object, origin);
    if (!transforms) return;
    const auto& columns = transforms->columns;
    RTCGeometry node = rtcNewGeometry(kept->device(), RTC_GEOMETRY_TYPE_INSTANCE);
    const KeptRayShape& kept_shape = shape_of(index);
    rtcSetGeometryInstancedScene(node, kept_shape.built.get());
    rtcSetGeometryTimeStepCount(node, static_cast<unsigned>(columns.size()));
    for (unsigned k = 0; k < columns.size(); ++k)
        rtcSetGeometryTransform(node, k, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns[k].data());
    rtcCommitGeometry(node);
    if (columns.size() > 1 || kept_shape.shape->knots() > 1 || !instance.lifespan.is_whole())
        motion.add(box_of(kept_shape.built.get()), transforms->knots);
    rtcAttachGeometryByID(top.get(), node, static_cast<unsigned>(instances.size()));
    rtcReleaseGeometry(node);
    by_key[instance.key] = static_cast<std::uint32_t>(instances.size());
    RayInstance& added =
        instances.emplace_back(RayInstance{index, transforms->scale, transforms->distance,
                                           lets_light_through(instance), constant_of(instance)});
    if (added.lets_light_through && instance.world_from_object.size() <= 1)
        added.still.emplace(matrix_at(instance.world_from_object, 0.0));
}

Vec3f RayScene::Impl::transparency(const ShadowContext& context, const RTCRay& ray,
                                   const RTCHit& hit, const RayInstance& instance) const {
    const Instance& source = scene.instances[instance.index];
    ShadowHit shadow;
    shadow.instance = instance.index;
    shape_of(instance.index).shape->locate(hit.geomID, hit.primID, hit.u, hit.v, shadow);
    shadow.material = source.material(shadow.slot);
    if (!opacity.is_transparent(shadow.material)) return Vec3f(0.0f);
    shadow.direction = context.direction;
    shadow.p = context.start + context.direction * ray.tfar;
    shadow.distance = ray.tfar;
    std::optional<ShadowFrame> moved;
    if (!instance.still) moved.emplace(matrix_at(source.world_from_object, ray.time));
    shadow.frame = instance.still ? &*instance.still : &*moved;
    if (shadow.elements) {  // they face the ray
        shadow.normal = -shadow.direction;
        return opacity.transparency(shadow);
    }
    shadow.normal =
        Vec3f(normalize_or(shadow.frame->world_from_normal * Vec3d(hit.Ng_x, hit.Ng_y, hit.Ng_z),
                           -Vec3d(shadow.direction)));
    return opacity.transparency(shadow);
}

/// Called for hits on geometry that may let light through, not exist or not be in the light's set:
/// goes on while light is left. Without spatial splits (medium quality) Embree meets a triangle
/// once.
void RayScene::Impl::pass_through(const RTCFilterFunctionNArguments* arguments) {
    auto* context = reinterpret_cast<ShadowContext*>(arguments->context);
    if (context->looked_at) {
        for (unsigned i = 0; i < arguments->N; ++i)
            if (arguments->valid[i] == -1)
                context->looked_at[RTCRayN_id(arguments->ray, arguments->N, i)] = true;
        return;
    }
    if (arguments->valid[0] != -1) return;
    const auto* scene = static_cast<const Impl*>(context->scene);
    const RayInstance& instance = scene->instances[arguments->context->instID[0]];
    const float time = reinterpret_cast<const RTCRay*>(arguments->ray)->time;
    const Instance& met = scene->scene.instances[instance.index];
    if (!met.lifespan.contains(time) || !in_light_set(met.blocks, context->blocker_set)) {
        arguments->valid[0] = 0;
        return;
    }
    if (!instance.lets_light_through) return;
    try {
        context->left *=
            instance.constant
                ? *instance.constant
                : scene->transparency(*context, *reinterpret_cast<const RTCRay*>(arguments->ray),
                                      *reinterpret_cast<const RTCHit*>(arguments->hit), instance);
    } catch (...) {
        context->failure = std::current_exception();  // thrown on after Embree's frames are left
        return;
    }
    if (context->left != Vec3f(0.0f)) arguments->valid[0] = 0;
}

RayScene::RayScene(const Scene& scene, const Vec3d& origin, ShadowOpacity opacity,
                   const Progress& progress, std::shared_ptr<GeometryCache> geometries,
                   Report* report, std::shared_ptr<KeptRays> kept, const Displacement* displacement)
    : m_impl(std::make_unique<Impl>(scene, std::move(opacity), std::move(geometries),
                                    std::move(kept), displacement, origin)) {
    Report unread;
    Report& warnings = report ? *report : unread;
    Impl& impl = *m_impl;
    std::vector<std::uint8_t> uses(scene.geometries.size(), 0);
    std::map<std::size_t, std::uint8_t> displaced;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (!impl.casts_shadow(instance)) continue;
        std::uint8_t& use = impl.is_displaced(i)
                                ? displaced[displacement->same_as(i)]
                                : uses[static_cast<std::size_t>(instance.geometry)];
        use |= kCasts;
        if (impl.lets_light_through(instance)) use |= kLetsLightThrough;
        if (!instance.lifespan.is_whole()) use |= kAppears;
        if (instance.blocks != ~0ULL) use |= kIsLinked;
    }
    if (displaced.empty() &&
        std::all_of(uses.begin(), uses.end(), [](std::uint8_t use) { return use == 0; }))
        return;
    if (!impl.kept) impl.kept = std::make_shared<KeptRays>();
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
    rtcSetSceneProgressMonitorFunction(impl.top.get(), goes_on, const_cast<Progress*>(&progress));
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
        if (impl.casts_shadow(scene.instances[i])) impl.add_instance(i, origin);
    {
        const ForeignThreads embree;
        rtcCommitScene(impl.top.get());
    }
    impl.check("scene of " + std::to_string(impl.instances.size()) + " instances", progress);
    // Embree keeps the pointer; the frame's progress may die before the scene does.
    rtcSetSceneProgressMonitorFunction(impl.top.get(), nullptr, nullptr);
}

RayScene::~RayScene() = default;

bool RayScene::empty() const {
    return m_impl->instances.empty();
}

std::size_t RayScene::bytes() const {
    std::size_t sum = m_impl->kept ? m_impl->kept->embree_bytes() : 0;
    for (const auto& shape : m_impl->shapes)
        if (shape) sum += shape->shape->bytes();
    for (const auto& [instance, shape] : m_impl->displaced) sum += shape->shape->bytes();
    return sum;
}

RayOffset RayScene::ray_offset(const GridKey& key) const {
    const auto found = m_impl->by_key.find(key.instance);
    if (found == m_impl->by_key.end()) return {};
    const RayInstance& instance = m_impl->instances[found->second];
    const RayShape& shape = *m_impl->shape_of(instance.index).shape;
    return {instance.distance, instance.scale * shape.extent(key.face),
            instance.scale * shape.error(key.face), true};
}

bool RayScene::moves() const {
    return !m_impl->motion.empty();
}

bool RayScene::varies(const Vec3f& start, const Vec3f& direction, float distance) const {
    return m_impl->motion.meet(start, direction, distance);
}

bool RayScene::is_displaced(const GridKey& key) const {
    const auto found = m_impl->by_key.find(key.instance);
    return found != m_impl->by_key.end() &&
           m_impl->is_displaced(m_impl->instances[found->second].index);
}

std::vector<float> RayScene::heights_over(const GridKey& key, const Covered& points) const {
    const std::size_t index = m_impl->instances[m_impl->by_key.at(key.instance)].index;
    const std::vector<Mat4d>& knots = m_impl->scene.instances[index].world_from_object;
    const float reach = 2.0f * m_impl->displacement->bound(index);
    RTCScene built = m_impl->shape_of(index).built.get();
    const auto object_from_shading = [&](float time) {
        Mat4d shading_from_object = matrix_at(knots, time);
        shading_from_object[3] -= glm::dvec4(m_impl->origin, 0.0);
        return glm::inverse(shading_from_object);
    };
    const float frame = m_impl->scene.options.frame_time;
    const bool still = is_static(knots);
    Mat4d into = object_from_shading(frame);
    std::vector<float> heights(points.p.size(), 0.0f);
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const bool timed = !points.times.empty() && points.times[i] >= 0.0f;
        const float time = timed ? points.times[i] : frame;
        if (!still && !points.times.empty()) into = object_from_shading(time);
        const Vec3f way(Mat3d(into) * Vec3d(points.up[i]));
        const float length = glm::length(way);
        if (!(length > 0.0f)) continue;
        const ShadowRay up{Vec3f(transform_point(into, Vec3d(points.p[i]))), way / length, reach,
                           time};
        if (!up.is_traceable()) continue;
        const float distance = covering_distance(built, up, points.from_behind[i] != 0);
        if (std::isfinite(distance)) heights[i] = distance / length;
    }
    return heights;
}

Vec3f RayScene::transmittance(const ShadowRay& shadow) const {
    if (!shadow.is_traceable()) return Vec3f(1.0f);
    ShadowContext context{};
    rtcInitIntersectContext(&context.embree);
    context.scene = m_impl.get();
    context.start = shadow.start;
    context.direction = shadow.direction;
    context.blocker_set = shadow.blocker_set;
    RTCRay ray{};
    ray.org_x = shadow.start.x, ray.org_y = shadow.start.y, ray.org_z = shadow.start.z;
    ray.dir_x = shadow.direction.x, ray.dir_y = shadow.direction.y, ray.dir_z = shadow.direction.z;
    ray.tnear = 0.0f;
    ray.tfar = shadow.distance;
    ray.time = shadow.time;
    ray.mask = ~0u;
    rtcOccluded1(m_impl->top.get(), &context.embree, &ray);
    if (context.failure) std::rethrow_exception(context.failure);
    return ray.tfar < 0.0f ? Vec3f(0.0f) : context.left;
}

void RayScene::transmittances(std::span<const ShadowRay> rays, std::span<Vec3f> left) const {
    bool looked_at[kPacket];
    ShadowContext context{};
    rtcInitIntersectContext(&context.embree);
    context.looked_at = looked_at;
    for (std::size_t first = 0; first < rays.size(); first += kPacket) {
        const std::size_t count = std::min(kPacket, rays.size() - first);
        std::fill_n(looked_at, kPacket, false);
        alignas(64) RTCRay16 packet{};
        alignas(64) int valid[kPacket]{};
        for (std::size_t i = 0; i < count; ++i) {
            const ShadowRay& ray = rays[first + i];
            if (!ray.is_traceable()) continue;
            packet.org_x[i] = ray.start.x;
            packet.org_y[i] = ray.start.y;
            packet.org_z[i] = ray.start.z;
            packet.dir_x[i] = ray.direction.x;
            packet.dir_y[i] = ray.direction.y;
            packet.dir_z[i] = ray.direction.z;
            packet.tfar[i] = ray.distance;
            packet.time[i] = ray.time;
            packet.mask[i] = ~0u;
            packet.id[i] = static_cast<unsigned>(i);
            valid[i] = -1;
        }
        rtcOccluded16(valid, m_impl->top.get(), &context.embree, &packet);
        for (std::size_t i = 0; i < count; ++i)
            left[first + i] = looked_at[i] ? transmittance(rays[first + i])
                                           : Vec3f(packet.tfar[i] < 0.0f ? 0.0f : 1.0f);
    }
}

}  // namespace granita
