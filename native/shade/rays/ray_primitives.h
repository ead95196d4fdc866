// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles or quads over knots as Embree takes them.  Of what deforms, the primitives that stand
// still are a geometry of their own: rays pass them without asking for the time.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace granita {

/// One of Embree's geometries: `count` primitives of so many corners, whose buffers it keeps; of
/// curves and points no corners.
struct RayPart {
    RTCGeometry geometry;
    std::uint32_t count = 0;
    std::uint32_t corners = 0;
    int knots = 1;
};

/// N: 3 or 4.  Embree cuts a quad between its second and its fourth corner.
template <std::size_t N>
struct RayPrimitives {
    int knots = 1;
    std::vector<Vec3f> points;  ///< [knots][points]
    std::vector<std::array<std::uint32_t, N>> indices;

    std::size_t point_count() const { return points.size() / static_cast<std::size_t>(knots); }
    std::span<const Vec3f> at(int knot) const {
        return std::span(points).subspan(static_cast<std::size_t>(knot) * point_count(),
                                         point_count());
    }
    /// Once all are there.
    void put_still_first();
    /// As RayShape::hand_over(); points and indices are given back.
    std::vector<RayPart> hand_over(RTCDevice device);
    /// The number that a primitive of a geometry handed over had before put_still_first().
    std::uint32_t original(std::uint32_t geometry, std::uint32_t primitive) const {
        if (m_order.empty()) return primitive;
        return m_order[geometry == 0 ? primitive : m_still + primitive];
    }
    std::size_t bytes() const {
        return points.size() * sizeof(Vec3f) + indices.size() * sizeof(indices[0]) +
               m_order.size() * sizeof(m_order[0]);
    }

  private:
    std::size_t m_still = 0;             ///< primitives that stand still, of a mesh that deforms
    std::vector<std::uint32_t> m_order;  ///< [primitives] where they were before; empty = here
};

extern template struct RayPrimitives<3>;
extern template struct RayPrimitives<4>;

}  // namespace granita
