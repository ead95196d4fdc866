// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_triangles.h"

#include <vector>

#include "scene/knot_time.h"
#include "shade/rays/persistent_rays.h"

namespace granita {
namespace {

/// As Embree cuts a quad.
constexpr std::array<std::array<std::uint32_t, 3>, 2> kHalves{{{0, 1, 3}, {2, 3, 1}}};

/// [points] of an Embree geometry at a knot.
const Vec3f* points_of(const RayPart& part, int knot) {
    return static_cast<const Vec3f*>(rtcGetGeometryBufferData(part.geometry, RTC_BUFFER_TYPE_VERTEX,
                                                              static_cast<unsigned>(knot)));
}

/// [primitives][part.corners]
const std::uint32_t* indices_of(const RayPart& part) {
    return static_cast<const std::uint32_t*>(
        rtcGetGeometryBufferData(part.geometry, RTC_BUFFER_TYPE_INDEX, 0));
}

}  // namespace

RayCorners corners_at(const RayPart& part, std::uint32_t primitive, float time) {
    const KnotTime at = knot_time(static_cast<double>(time), part.knots);
    const std::uint32_t* of = indices_of(part) + std::size_t{primitive} * part.corners;
    const Vec3f* now = points_of(part, static_cast<int>(at.knot));
    RayCorners corners{{}, part.corners};
    for (std::uint32_t c = 0; c < part.corners; ++c) corners.points[c] = now[of[c]];
    if (at.fraction == 0.0) return corners;
    const Vec3f* next = points_of(part, static_cast<int>(at.knot) + 1);
    for (std::uint32_t c = 0; c < part.corners; ++c)
        corners.points[c] += static_cast<float>(at.fraction) * (next[of[c]] - corners.points[c]);
    return corners;
}

void for_each_triangle(const PersistentRayShape& of, std::uint32_t instance,
                       const std::function<void(const RayTriangle&)>& visit) {
    std::vector<std::array<Vec3f, 3>> corners;
    for (std::uint32_t g = 0; g < of.parts.size(); ++g) {
        const RayPart& part = of.parts[g];
        if (part.corners == 0) continue;
        const auto knots = static_cast<unsigned>(part.knots);
        std::vector<const Vec3f*> points;
        points.reserve(knots);
        for (int knot = 0; knot < part.knots; ++knot) points.push_back(points_of(part, knot));
        const std::uint32_t* indices = indices_of(part);
        corners.resize(knots);
        for (std::uint32_t k = 0; k < part.count; ++k) {
            const std::uint32_t* of_primitive = indices + std::size_t{k} * part.corners;
            RayHit hit;
            of.shape->locate(g, k, 0.25f, 0.25f, hit);
            for (std::size_t half = 0; half < (part.corners == 4 ? 2u : 1u); ++half) {
                for (unsigned knot = 0; knot < knots; ++knot)
                    for (std::size_t c = 0; c < 3; ++c)
                        corners[knot][c] =
                            points[knot][of_primitive[part.corners == 4 ? kHalves[half][c] : c]];
                visit({hit.slot, {instance, g, k}, corners});
            }
        }
    }
}

}  // namespace granita
