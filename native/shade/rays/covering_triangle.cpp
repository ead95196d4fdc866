// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/covering_triangle.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "shade/rays/set_ray.h"

namespace granita {
namespace {

/// Of the half of a quad that was hit: (0, 1, 3), or (2, 3, 1) from u + v = 1 on.
float longest_edge(RTCScene built, const RTCHit& hit) {
    RTCGeometry of = rtcGetGeometry(built, hit.geomID);
    const auto* corners = static_cast<const std::array<std::uint32_t, 4>*>(
        rtcGetGeometryBufferData(of, RTC_BUFFER_TYPE_INDEX, 0));
    const auto* points =
        static_cast<const Vec3f*>(rtcGetGeometryBufferData(of, RTC_BUFFER_TYPE_VERTEX, 0));
    const auto& quad = corners[hit.primID];
    const Vec3f &a = points[quad[hit.u + hit.v > 1.0f ? 2 : 0]], &b = points[quad[1]],
                &c = points[quad[3]];
    return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
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
    if (!leaves || ray.ray.tfar > kFarthest * longest_edge(built, ray.hit)) return kNone;
    return ray.ray.tfar;
}

}  // namespace granita
