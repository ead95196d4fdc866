// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/covering_triangle.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "shade/rays/set_ray.h"

namespace granita {
namespace {

float longest_edge(RTCScene built, unsigned geometry, unsigned triangle) {
    RTCGeometry of = rtcGetGeometry(built, geometry);
    const auto* corners = static_cast<const std::array<std::uint32_t, 3>*>(
        rtcGetGeometryBufferData(of, RTC_BUFFER_TYPE_INDEX, 0));
    const auto* points =
        static_cast<const Vec3f*>(rtcGetGeometryBufferData(of, RTC_BUFFER_TYPE_VERTEX, 0));
    const auto& [a, b, c] = corners[triangle];
    return std::max({glm::distance(points[a], points[b]), glm::distance(points[b], points[c]),
                     glm::distance(points[c], points[a])});
}

}  // namespace

float covering_distance(RTCScene built, const Ray& from, bool from_behind) {
    /// Of a triangle's longest edge.
    constexpr float kFarthest = 2.0f;
    constexpr float kNone = std::numeric_limits<float>::infinity();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    set_ray(ray.ray, from);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(built, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return kNone;
    const Vec3f across(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
    const bool leaves = (glm::dot(across, from.direction) > 0.0f) != from_behind;
    if (!leaves || ray.ray.tfar > kFarthest * longest_edge(built, ray.hit.geomID, ray.hit.primID))
        return kNone;
    return ray.ray.tfar;
}

}  // namespace granita
