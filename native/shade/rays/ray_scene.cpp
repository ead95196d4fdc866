// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "math/normalize_or.h"
#include "scene/knot_time.h"
#include "shade/rays/covering_triangle.h"
#include "shade/rays/ray_scene_impl.h"
#include "shade/rays/ray_transforms.h"
#include "shade/rays/ray_visibility.h"
#include "shade/rays/set_ray.h"
#include "shade/rays/sphere_fronts.h"

namespace granita {
namespace {

/// Rays traced at once.
constexpr std::size_t kPacket = 16;

}  // namespace

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
    bool all_opaque = false;
    const Ray* rays = nullptr;  ///< by their ids
    std::exception_ptr failure;
};

void RayScene::Impl::locate(const RTCRay& traced, const RTCHit& at, std::uint32_t instance,
                            const Vec3f& start, const Vec3f& direction, RayHit& hit) const {
    const Instance& source = scene.instances[instance];
    hit.instance = instance;
    hit.target = {at.instID[0], at.geomID, at.primID};
    shape_of(instance).shape->locate(at.geomID, at.primID, at.u, at.v, hit);
    hit.material = source.material(hit.slot);
    hit.direction = direction;
    hit.p = start + direction * traced.tfar;
    hit.distance = traced.tfar;
}

Vec3f RayScene::Impl::normal_of(const RTCHit& at, const RayHit& hit, const RayFrame& frame) {
    const bool is_hair = hit.elements && hit.elements->data().kind == GeometryKind::Curves;
    if (is_hair) return -hit.direction;  // ribbons face the ray
    return Vec3f(normalize_or(frame.world_from_normal * Vec3d(at.Ng_x, at.Ng_y, at.Ng_z),
                              -Vec3d(hit.direction)));
}

RayFrame RayScene::Impl::frame_at(std::uint32_t instance, float time) const {
    return RayFrame(matrix_at(scene.instances[instance].world_from_object, time));
}

Vec3f RayScene::Impl::transparency(const ShadowContext& context, const RTCRay& ray,
                                   const RTCHit& at, const RayInstance& instance) const {
    RayHit hit;
    locate(ray, at, instance.index, context.start, context.direction, hit);
    if (!materials.is_transparent(hit.material)) return Vec3f(0.0f);
    if (materials.is_painted && materials.is_painted(hit.material, context.rays->type))
        return materials.transparency(hit, context.rays->type);
    hit.frame = instance.still ? &*instance.still : nullptr;
    std::optional<RayFrame> moved;
    if (!hit.frame) hit.frame = &moved.emplace(frame_at(hit.instance, ray.time));
    hit.normal = normal_of(at, hit, *hit.frame);
    return materials.transparency(hit, context.rays->type);
}

/// Whoever looks at what shines sees its near side, whatever shadow it casts: light of the far one
/// would come to it twice.
bool RayScene::Impl::hides_itself(const ShadowContext& context, const RTCRay& ray, const RTCHit& at,
                                  const RayInstance& instance) const {
    const bool blocks = in_light_set(scene.instances[instance.index].blocks, context.blocker_set);
    if (context.rays->type != RayType::Shadow || !blocks || !materials.emitted) return false;
    RayHit hit;
    locate(ray, at, instance.index, context.start, context.direction, hit);
    return materials.emitted(hit.material) != Vec3f(0.0f);
}

/// Called for hits on geometry that may let light through, not exist or not be in the light's set:
/// goes on while light is left. Without spatial splits (medium quality) Embree meets a triangle
/// once.  Spheres of points are met from outside alone.
void RayScene::Impl::pass_through(const RTCFilterFunctionNArguments* arguments) {
    auto* context = reinterpret_cast<ShadowContext*>(arguments->context);
    const auto* scene = static_cast<const Impl*>(context->scene);
    const unsigned id = arguments->context->instID[0];
    const RayInstance& instance = scene->instances[id];
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1) continue;
        const Ray& ray = context->rays[RTCRayN_id(arguments->ray, arguments->N, i)];
        const RayTarget met{id, RTCHitN_geomID(arguments->hit, arguments->N, i),
                            RTCHitN_primID(arguments->hit, arguments->N, i)};
        if (met == ray.target || (instance.of_points && leaves(arguments, i)))
            arguments->valid[i] = 0;
        else if (context->looked_at != nullptr && !instance.is_plain)
            context->looked_at[RTCRayN_id(arguments->ray, arguments->N, i)] = true;
    }
    if (context->looked_at != nullptr || arguments->valid[0] != -1 || instance.is_plain) return;
    const auto& traced = *reinterpret_cast<const RTCRay*>(arguments->ray);
    const float time = traced.time;
    const Instance& met = scene->scene.instances[instance.index];
    const RayType type = context->rays->type;
    const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
    const bool is_met = meets(type, met, context->blocker_set) ||
                        (id == context->rays->target.instance &&
                         scene->hides_itself(*context, traced, hit, instance));
    if (!is_met || !met.lifespan.contains(time)) {
        arguments->valid[0] = 0;
        return;
    }
    if (!instance.lets_light_through || context->all_opaque) return;
    try {
        context->left *= instance.constant ? *instance.constant
                                           : scene->transparency(*context, traced, hit, instance);
    } catch (...) {
        context->failure = std::current_exception();  // thrown on after Embree's frames are left
        return;
    }
    if (context->left != Vec3f(0.0f)) arguments->valid[0] = 0;
}

/// What does not exist at the ray's time, or is hidden from its like, is not met.
void RayScene::Impl::skip_absent(const RTCFilterFunctionNArguments* arguments) {
    const unsigned id = arguments->context->instID[0];
    if (arguments->valid[0] != -1 || id == RTC_INVALID_GEOMETRY_ID) return;
    const auto& context = *reinterpret_cast<const MetContext*>(arguments->context);
    const auto* scene = static_cast<const Impl*>(context.scene);
    if (context.crossings) return scene->note_crossing(arguments);
    const Ray& ray = context.rays[reinterpret_cast<const RTCRay*>(arguments->ray)->id];
    const RayInstance& instance = scene->instances[id];
    const Instance& met = scene->scene.instances[instance.index];
    const bool is_there = meets(ray.type, met) && met.lifespan.contains(ray.time);
    if (!is_there || (instance.of_points && leaves(arguments, 0))) arguments->valid[0] = 0;
}

RayScene::~RayScene() = default;

bool RayScene::empty() const {
    return m_impl->instances.empty() && !m_impl->volumes && !m_impl->materials.dim;
}

RayOffset RayScene::ray_offset(const GridKey& key) const {
    const auto found = m_impl->by_key.find(key.instance);
    if (found == m_impl->by_key.end()) return {};
    const RayInstance& instance = m_impl->instances[found->second];
    const RayShape& shape = *m_impl->shape_of(instance.index).shape;
    return {instance.distance, instance.scale * shape.extent(key.face),
            instance.scale * shape.error(key.face), true};
}

std::vector<Mat4d> RayScene::transforms(std::size_t instance) const {
    if (!m_impl->by_key.contains(m_impl->scene.instances[instance].key)) return {};
    const auto made =
        ray_transforms(m_impl->scene.instances[instance].world_from_object, m_impl->origin);
    return made ? made->knots : std::vector<Mat4d>{};
}

void RayScene::triangles(std::size_t instance,
                         const std::function<void(const RayTriangle&)>& visit) const {
    const std::uint32_t id = m_impl->by_key.at(m_impl->scene.instances[instance].key);
    for_each_triangle(m_impl->shape_of(instance), id, visit);
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
        const Ray up{Vec3f(transform_point(into, Vec3d(points.p[i]))), way / length, reach, time};
        if (!up.is_traceable()) continue;
        const float distance = covering_distance(built, up, points.from_behind[i] != 0);
        if (std::isfinite(distance)) heights[i] = distance / length;
    }
    return heights;
}

void RayScene::nearest(std::span<const Ray> rays, std::vector<Met>& out) const {
    out.clear();
    if (!m_impl->top) return;
    MetContext context{};
    rtcInitIntersectContext(&context.embree);
    context.scene = m_impl.get();
    context.rays = rays.data();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& ray = rays[i];
        if (!ray.is_traceable()) continue;
        RTCRayHit traced{};
        set_ray(traced.ray, ray);
        traced.ray.id = static_cast<unsigned>(i);
        traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(m_impl->top.get(), &context.embree, &traced);
        if (traced.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
        Met& met = out.emplace_back(Met{static_cast<std::uint32_t>(i), {}, {}});
        const RayInstance& instance = m_impl->instances[traced.hit.instID[0]];
        m_impl->locate(traced.ray, traced.hit, instance.index, ray.start, ray.direction, met.hit);
        met.hit.frame = instance.still ? &*instance.still : nullptr;
        if (!met.hit.frame) met.moved.emplace(m_impl->frame_at(met.hit.instance, ray.time));
        met.hit.normal = Impl::normal_of(traced.hit, met.hit, met.frame());
    }
}

bool RayScene::has_body(const GridKey& key) const {
    const auto found = m_impl->by_key.find(key.instance);
    if (found == m_impl->by_key.end()) return false;
    const Instance& source = m_impl->scene.instances[m_impl->instances[found->second].index];
    return m_impl->scene.geometries[static_cast<std::size_t>(source.geometry)].kind ==
           GeometryKind::Mesh;
}

RayScene::Body RayScene::body(const GridKey& key, float time) const {
    const RayInstance& instance = m_impl->instances[m_impl->by_key.at(key.instance)];
    Mat4d shading_from_object =
        matrix_at(m_impl->scene.instances[instance.index].world_from_object, time);
    shading_from_object[3] -= glm::dvec4(m_impl->origin, 0.0);
    Body body{instance.index,
              glm::inverse(shading_from_object),
              time,
              instance.still ? &*instance.still : nullptr,
              {}};
    if (!body.still) body.moved.emplace(m_impl->frame_at(instance.index, time));
    return body;
}

bool RayScene::nearest(const Body& body, const Ray& ray, Met& met) const {
    if (!ray.is_traceable()) return false;
    // Not of unit length in the object, so that distances stay those of the world.
    const Ray inside{Vec3f(transform_point(body.object_from_shading, Vec3d(ray.start))),
                     Vec3f(Mat3d(body.object_from_shading) * Vec3d(ray.direction)), ray.distance,
                     body.time};
    if (!inside.is_traceable()) return false;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit traced{};
    set_ray(traced.ray, inside);
    traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(m_impl->shape_of(body.instance).built.get(), &context, &traced);
    if (traced.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    m_impl->locate(traced.ray, traced.hit, body.instance, ray.start, ray.direction, met.hit);
    met.hit.frame = body.still;
    met.moved = body.moved;
    met.hit.normal = Impl::normal_of(traced.hit, met.hit, met.frame());
    return true;
}

Vec3f RayScene::transmittance(const Ray& shadow) const {
    Vec3f left = past_surfaces(shadow);
    if (m_impl->materials.dim && left != Vec3f(0.0f))
        m_impl->materials.dim({&shadow, 1}, {&left, 1});
    return left;
}

bool RayScene::blocks(const Ray& shadow) const {
    if (!shadow.is_traceable() || !m_impl->top) return false;
    ShadowContext context{};
    rtcInitIntersectContext(&context.embree);
    context.scene = m_impl.get();
    context.all_opaque = true;
    context.rays = &shadow;
    RTCRay ray{};
    set_ray(ray, shadow);
    rtcOccluded1(m_impl->top.get(), &context.embree, &ray);
    return ray.tfar < 0.0f;
}

Vec3f RayScene::past_surfaces(const Ray& shadow) const {
    if (!shadow.is_traceable() || !m_impl->top) return Vec3f(1.0f);
    ShadowContext context{};
    rtcInitIntersectContext(&context.embree);
    context.scene = m_impl.get();
    context.start = shadow.start;
    context.direction = shadow.direction;
    context.blocker_set = shadow.blocker_set;
    context.rays = &shadow;
    RTCRay ray{};
    set_ray(ray, shadow);
    rtcOccluded1(m_impl->top.get(), &context.embree, &ray);
    if (context.failure) std::rethrow_exception(context.failure);
    return ray.tfar < 0.0f ? Vec3f(0.0f) : context.left;
}

void RayScene::transmittances(std::span<const Ray> rays, std::span<Vec3f> left) const {
    past_surfaces(rays, left);
    if (m_impl->materials.dim) m_impl->materials.dim(rays, left);
}

void RayScene::past_surfaces(std::span<const Ray> rays, std::span<Vec3f> left) const {
    if (!m_impl->top) {
        std::ranges::fill(left, Vec3f(1.0f));
        return;
    }
    bool looked_at[kPacket];
    ShadowContext context{};
    rtcInitIntersectContext(&context.embree);
    context.looked_at = looked_at;
    context.scene = m_impl.get();
    for (std::size_t first = 0; first < rays.size(); first += kPacket) {
        const std::size_t count = std::min(kPacket, rays.size() - first);
        std::fill_n(looked_at, kPacket, false);
        context.rays = &rays[first];
        alignas(64) RTCRay16 packet{};
        alignas(64) int valid[kPacket]{};
        for (std::size_t i = 0; i < count; ++i) {
            const Ray& ray = rays[first + i];
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
            left[first + i] = looked_at[i] ? past_surfaces(rays[first + i])
                                           : Vec3f(packet.tfar[i] < 0.0f ? 0.0f : 1.0f);
    }
}

}  // namespace granita
