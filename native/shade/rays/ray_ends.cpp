// SPDX-License-Identifier: GPL-3.0-or-later
// Where rays end on what they were aimed at.
#include <algorithm>
#include <cmath>

#include "scene/knot_time.h"
#include "shade/rays/ray_scene_impl.h"
#include "shade/rays/ray_triangles.h"

namespace granita {
namespace {

/// Fills the place on a triangle or quad, as Embree tells it, of a point that lies on it.
void place_on(const RayCorners& corners, const Vec3f& p, RTCHit& at) {
    struct Half {
        std::array<std::size_t, 3> of;
        bool is_second;
    };
    const bool is_quad = corners.count == 4;
    const Half halves[] = {{{0, 1, is_quad ? 3u : 2u}, false}, {{2, 3, 1}, true}};
    float best = -INFINITY;
    for (std::size_t h = 0; h < (is_quad ? 2u : 1u); ++h) {
        const Vec3f& origin = corners.points[halves[h].of[0]];
        const Vec3f a = corners.points[halves[h].of[1]] - origin;
        const Vec3f b = corners.points[halves[h].of[2]] - origin;
        const Vec3f normal = glm::cross(a, b);
        const float squared = glm::dot(normal, normal);
        if (!(squared > 0.0f)) continue;
        const float u = glm::dot(glm::cross(p - origin, b), normal) / squared;
        const float v = glm::dot(glm::cross(a, p - origin), normal) / squared;
        const float inside = std::min({u, v, 1.0f - u - v});
        if (!(inside > best)) continue;
        best = inside;
        const float s = std::clamp(u, 0.0f, 1.0f), t = std::clamp(v, 0.0f, 1.0f - s);
        at.u = halves[h].is_second ? 1.0f - s : s;
        at.v = halves[h].is_second ? 1.0f - t : t;
        at.Ng_x = normal.x;
        at.Ng_y = normal.y;
        at.Ng_z = normal.z;
    }
}

}  // namespace

void RayScene::ends(std::span<const Ray> rays, std::vector<Met>& out) const {
    out.clear();
    std::uint32_t of = ~0u;
    float time = 0.0f;
    Mat4d into(1.0);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& ray = rays[i];
        const RayInstance& instance = m_impl->instances[ray.target.instance];
        const std::vector<Mat4d>& knots = m_impl->scene.instances[instance.index].world_from_object;
        if (of != ray.target.instance || (time != ray.time && knots.size() > 1)) {
            of = ray.target.instance;
            time = ray.time;
            into = matrix_at(knots, time);
            into[3] -= glm::dvec4(m_impl->origin, 0.0);
            into = glm::inverse(into);
        }
        const RayPart& part = m_impl->shape_of(instance.index).parts[ray.target.geometry];
        RTCRay traced{};
        traced.tfar = ray.distance;
        RTCHit at{};
        at.instID[0] = ray.target.instance;
        at.geomID = ray.target.geometry;
        at.primID = ray.target.primitive;
        const Vec3f end = ray.start + ray.distance * ray.direction;
        place_on(corners_at(part, ray.target.primitive, ray.time),
                 Vec3f(transform_point(into, Vec3d(end))), at);
        Met& met = out.emplace_back(Met{static_cast<std::uint32_t>(i), {}, {}});
        m_impl->locate(traced, at, instance.index, ray.start, ray.direction, met.hit);
        met.hit.frame = instance.still ? &*instance.still : nullptr;
        if (!met.hit.frame) met.moved.emplace(m_impl->frame_at(met.hit.instance, ray.time));
        met.hit.normal = Impl::normal_of(at, met.hit, met.frame());
    }
}

}  // namespace granita
