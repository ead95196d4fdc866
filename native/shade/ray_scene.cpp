// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <unordered_map>

#include "shade/ray_mesh.h"
#include "shade/shading_points.h"

namespace granita {
namespace {

/// Positions are rounded to float in shading space and again in object space, each to 2^-24 of the
/// largest coordinate on the way; 2^-20 leaves room for a dozen such steps.
constexpr float kRounding = 0x1p-20f;

struct Releaser {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
template <class T>
using Handle = std::unique_ptr<std::remove_pointer_t<T>, Releaser>;

bool add_bytes(void* user, ssize_t bytes, bool) {
    static_cast<std::atomic<long long>*>(user)->fetch_add(bytes, std::memory_order_relaxed);
    return true;
}

bool goes_on(void* user, double) {
    return !static_cast<const Progress*>(user)->cancelled();
}

/// What an instance tells a ray.
struct RayInstance {
    std::uint32_t index = 0;  ///< in Scene::instances
    Mat3f normal_from_object{1.0f};
    float scale = 1.0f;     ///< largest stretch of the transform
    float rounding = 0.0f;  ///< metres
};

/// A ray and what is left of its light.
struct ShadowContext {
    RTCIntersectContext embree;  // first: Embree hands a pointer to it back
    const void* scene = nullptr;
    Vec3f left{1.0f};
    std::exception_ptr failure;
};

}  // namespace

struct RayScene::Impl {
    Impl(const Scene& frame_scene, ShadowOpacity shadow_opacity)
        : scene(frame_scene), opacity(std::move(shadow_opacity)) {}

    void check(const std::string& what, const Progress& progress) const;
    void build_geometry(int geometry, bool filtered, const Progress& progress);
    void add_instance(std::uint32_t index, const Vec3d& origin);
    bool lets_light_through(const Instance& instance) const;
    std::int32_t material_of(const Instance& instance, std::uint32_t face) const;
    Vec3f transparency(const RTCRay& ray, const RTCHit& hit, unsigned id) const;
    static void pass_through(const RTCFilterFunctionNArguments* arguments);

    const Scene& scene;
    ShadowOpacity opacity;
    std::atomic<long long> embree_bytes{0};
    Handle<RTCDevice> device;
    std::vector<std::unique_ptr<RayMesh>> meshes;  ///< [geometries] nullptr = casts no shadow
    std::vector<Handle<RTCScene>> geometries;      ///< [geometries]
    Handle<RTCScene> top;
    std::vector<RayInstance> instances;                       ///< by Embree's id in `top`
    std::unordered_map<std::uint32_t, std::uint32_t> by_key;  ///< Instance::key to that id
};

void RayScene::Impl::check(const std::string& what, const Progress& progress) const {
    progress.check();
    const RTCError error = rtcGetDeviceError(device.get());
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

void RayScene::Impl::build_geometry(int index, bool filtered, const Progress& progress) {
    const GeometryData& data = scene.geometries[static_cast<std::size_t>(index)];
    auto mesh = std::make_unique<RayMesh>(data, scene.options.frame_time, progress);
    Handle<RTCScene> built(rtcNewScene(device.get()));
    rtcSetSceneFlags(built.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(built.get(), RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneProgressMonitorFunction(built.get(), goes_on, const_cast<Progress*>(&progress));
    RTCGeometry triangles = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    // Copied: Embree reads 16 bytes at the last vertex, so a shared buffer needs padding.
    void* vertices =
        rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Vec3f), mesh->points().size());
    void* indices = rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(std::uint32_t), mesh->triangles().size());
    if (vertices != nullptr && indices != nullptr) {
        std::copy(mesh->points().begin(), mesh->points().end(), static_cast<Vec3f*>(vertices));
        std::copy(mesh->triangles().begin(), mesh->triangles().end(),
                  static_cast<std::array<std::uint32_t, 3>*>(indices));
        if (filtered) rtcSetGeometryOccludedFilterFunction(triangles, pass_through);
        rtcCommitGeometry(triangles);
        rtcAttachGeometry(built.get(), triangles);
    }
    rtcReleaseGeometry(triangles);
    rtcCommitScene(built.get());
    check(data.name + " of " + std::to_string(mesh->triangles().size()) + " triangles", progress);
    mesh->release_triangles();
    meshes[static_cast<std::size_t>(index)] = std::move(mesh);
    geometries[static_cast<std::size_t>(index)] = std::move(built);
}

void RayScene::Impl::add_instance(std::uint32_t index, const Vec3d& origin) {
    const Instance& instance = scene.instances[index];
    const auto geometry = static_cast<std::size_t>(instance.geometry);
    Mat4d m = matrix_at(instance.world_from_object, scene.options.frame_time);
    m[3] -= glm::dvec4(origin, 0.0);
    RayInstance added;
    added.index = index;
    added.normal_from_object = Mat3f(glm::transpose(glm::inverse(Mat3d(m))));
    added.scale = static_cast<float>(
        std::max({glm::length(Vec3d(m[0])), glm::length(Vec3d(m[1])), glm::length(Vec3d(m[2]))}));
    added.rounding = kRounding * (static_cast<float>(glm::length(Vec3d(m[3]))) +
                                  added.scale * meshes[geometry]->extent());
    float columns[12];
    for (int c = 0, k = 0; c < 4; ++c)
        for (int r = 0; r < 3; ++r, ++k) columns[k] = static_cast<float>(m[c][r]);
    // A transform without volume casts no shadow that rays could find.
    if (!std::all_of(std::begin(columns), std::end(columns),
                     [](float x) { return std::isfinite(x); }) ||
        glm::determinant(Mat3d(m)) == 0.0)
        return;
    RTCGeometry node = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(node, geometries[geometry].get());
    rtcSetGeometryTransform(node, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    rtcCommitGeometry(node);
    rtcAttachGeometryByID(top.get(), node, static_cast<unsigned>(instances.size()));
    rtcReleaseGeometry(node);
    by_key[instance.key] = static_cast<std::uint32_t>(instances.size());
    instances.push_back(added);
}

std::int32_t RayScene::Impl::material_of(const Instance& instance, std::uint32_t face) const {
    if (instance.materials.empty()) return -1;
    const GeometryData& data = scene.geometries[static_cast<std::size_t>(instance.geometry)];
    const std::int32_t slot = data.material_index.empty() ? 0 : data.material_index[face];
    const auto last = static_cast<std::int32_t>(instance.materials.size()) - 1;
    return instance.materials[static_cast<std::size_t>(std::clamp(slot, 0, last))];
}

Vec3f RayScene::Impl::transparency(const RTCRay& ray, const RTCHit& hit, unsigned id) const {
    const RayInstance& instance = instances[id];
    const Instance& source = scene.instances[instance.index];
    ShadowHit shadow;
    shadow.instance = instance.index;
    meshes[static_cast<std::size_t>(source.geometry)]->locate(hit.primID, hit.u, hit.v, shadow);
    shadow.material = material_of(source, shadow.patch->face);
    if (!opacity.is_transparent(shadow.material)) return Vec3f(0.0f);
    shadow.direction = {ray.dir_x, ray.dir_y, ray.dir_z};
    shadow.p = Vec3f(ray.org_x, ray.org_y, ray.org_z) + shadow.direction * ray.tfar;
    shadow.normal =
        glm::normalize(instance.normal_from_object * Vec3f(hit.Ng_x, hit.Ng_y, hit.Ng_z));
    return opacity.transparency(shadow);
}

/// Called for hits on geometry that may let light through: goes on while light is left.  Without
/// spatial splits (medium quality) Embree meets a triangle once.
void RayScene::Impl::pass_through(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->valid[0] != -1) return;
    auto* context = reinterpret_cast<ShadowContext*>(arguments->context);
    const auto* scene = static_cast<const Impl*>(context->scene);
    try {
        context->left *= scene->transparency(*reinterpret_cast<const RTCRay*>(arguments->ray),
                                             *reinterpret_cast<const RTCHit*>(arguments->hit),
                                             arguments->context->instID[0]);
    } catch (...) {
        context->failure = std::current_exception();  // thrown on after Embree's frames are left
        return;
    }
    if (context->left != Vec3f(0.0f)) arguments->valid[0] = 0;
}

RayScene::RayScene(const Scene& scene, const Vec3d& origin, ShadowOpacity opacity,
                   const Progress& progress)
    : m_impl(std::make_unique<Impl>(scene, std::move(opacity))) {
    Impl& impl = *m_impl;
    std::vector<std::uint8_t> used(scene.geometries.size(), 0);  // bit 1: by a shadow, 2: filtered
    for (const Instance& instance : scene.instances)
        if (instance.casts_shadow)
            used[static_cast<std::size_t>(instance.geometry)] |=
                impl.lets_light_through(instance) ? 3 : 1;
    if (std::all_of(used.begin(), used.end(), [](std::uint8_t bits) { return bits == 0; })) return;
    impl.device.reset(rtcNewDevice(nullptr));
    if (!impl.device)
        throw Error("Embree cannot start: error " + std::to_string(rtcGetDeviceError(nullptr)));
    rtcSetDeviceMemoryMonitorFunction(impl.device.get(), add_bytes, &impl.embree_bytes);
    impl.meshes.resize(scene.geometries.size());
    impl.geometries.resize(scene.geometries.size());
    for (std::size_t g = 0; g < used.size(); ++g) {
        progress.check();
        if (used[g]) impl.build_geometry(static_cast<int>(g), (used[g] & 2) != 0, progress);
    }
    impl.top.reset(rtcNewScene(impl.device.get()));
    rtcSetSceneFlags(impl.top.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneProgressMonitorFunction(impl.top.get(), goes_on, const_cast<Progress*>(&progress));
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
        if (scene.instances[i].casts_shadow) impl.add_instance(i, origin);
    rtcCommitScene(impl.top.get());
    impl.check("scene of " + std::to_string(impl.instances.size()) + " instances", progress);
    // Embree keeps the pointer; the frame's progress may die before the scene does.
    rtcSetSceneProgressMonitorFunction(impl.top.get(), nullptr, nullptr);
}

RayScene::~RayScene() = default;

bool RayScene::empty() const {
    return m_impl->instances.empty();
}

std::size_t RayScene::bytes() const {
    std::size_t sum = static_cast<std::size_t>(std::max(0LL, m_impl->embree_bytes.load()));
    for (const auto& mesh : m_impl->meshes)
        if (mesh) sum += mesh->bytes();
    return sum;
}

Vec3f RayScene::lift(const GridKey& key, const Vec3f& p, const Vec3f& geometric_normal) const {
    float height = kRounding * glm::length(p);
    const auto found = m_impl->by_key.find(key.instance);
    if (found != m_impl->by_key.end()) {
        const RayInstance& instance = m_impl->instances[found->second];
        const auto geometry =
            static_cast<std::size_t>(m_impl->scene.instances[instance.index].geometry);
        height += instance.rounding + instance.scale * m_impl->meshes[geometry]->error(key.face);
    }
    return p + geometric_normal * height;
}

Vec3f RayScene::transmittance(const Vec3f& start, const Vec3f& direction, float distance) const {
    ShadowContext context;
    rtcInitIntersectContext(&context.embree);
    context.scene = m_impl.get();
    RTCRay ray{};
    ray.org_x = start.x, ray.org_y = start.y, ray.org_z = start.z;
    ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
    ray.tnear = 0.0f;
    ray.tfar = distance;
    ray.mask = ~0u;
    rtcOccluded1(m_impl->top.get(), &context.embree, &ray);
    if (context.failure) std::rethrow_exception(context.failure);
    return ray.tfar < 0.0f ? Vec3f(0.0f) : context.left;
}

}  // namespace granita
