// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh as triangles for rays. Polygons are their own triangles; a subdivision surface is
// evaluated on its limit at a fixed number of points a face.  Of a mesh that deforms, the triangles
// that stand still are a geometry of their own: rays pass them without asking for the time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "geometry/shared_geometry.h"
#include "shade/ray_shape.h"

namespace granita {

class RayMesh final : public RayShape {
  public:
    RayMesh(const GeometryData& data, float frame_time, const Progress& progress);

    std::vector<RTCGeometry> hand_over(RTCDevice device) override;
    std::string size() const override;
    int knots() const override { return m_knots; }
    float error(std::uint32_t face) const override;
    float extent(std::uint32_t face) const override;
    const SharedGeometry& shared() const { return m_shared; }
    /// (u, v): the barycentric point of a triangle.
    void locate(std::uint32_t geometry, std::uint32_t triangle, float u, float v,
                ShadowHit& hit) const override;
    std::size_t bytes() const override;

  private:
    /// The vertices that the faces refer to.
    std::span<const Vec3f> vertices(int knot) const;
    void add_polygons();
    std::size_t point_count() const { return m_points.size() / static_cast<std::size_t>(m_knots); }
    std::span<const Vec3f> points(int knot) const {
        return std::span(m_points).subspan(static_cast<std::size_t>(knot) * point_count(),
                                           point_count());
    }
    void add_limit_surface(const Progress& progress);
    void put_still_first();

    SharedGeometry m_shared;
    int m_side = 1;  ///< cells along a side of a patch of a subdivision surface
    int m_knots = 1;
    std::vector<Vec3f> m_points;  ///< [knots][points]
    std::vector<std::array<std::uint32_t, 3>> m_triangles;
    std::size_t m_still = 0;               ///< triangles that stand still, of a mesh that deforms
    std::vector<std::uint32_t> m_order;    ///< [triangles] where they were before; empty = here
    std::vector<std::uint32_t> m_patches;  ///< [triangles] polygons: patch, doubled, plus half
    std::vector<float> m_errors;           ///< [faces]; empty = all 0
    std::vector<float> m_extents;          ///< [faces] polygons; empty: m_extent for all
    float m_extent = 0.0f;
};

}  // namespace granita
