// SPDX-License-Identifier: GPL-3.0-or-later
// A geometry as triangles for rays: view-independent, object space, at the frame time or, where it
// deforms, at each of its knots (decision 12). Polygons are their own triangles; a subdivision
// surface is evaluated on its limit at a fixed number of points a face.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "geometry/shared_geometry.h"
#include "shade/shadow_opacity.h"

namespace granita {

class RayMesh {
  public:
    RayMesh(const GeometryData& data, float frame_time, const Progress& progress);

    /// 1 = it does not deform.
    int knots() const { return m_knots; }
    std::size_t point_count() const { return m_points.size() / static_cast<std::size_t>(m_knots); }
    std::span<const Vec3f> points(int knot) const {
        return std::span(m_points).subspan(static_cast<std::size_t>(knot) * point_count(),
                                           point_count());
    }
    const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return m_triangles; }
    /// Once Embree has its own copy.
    void release_triangles();
    /// Largest distance between the surface of a face and its triangles at any knot, object space.
    float error(std::uint32_t face) const;
    /// Largest absolute coordinate: rounding grows with it.
    float extent() const { return m_extent; }
    const SharedGeometry& shared() const { return m_shared; }
    /// Fills geometry, patch and uv of a hit at the barycentric point (u, v) of a triangle.
    void locate(std::uint32_t triangle, float u, float v, ShadowHit& hit) const;
    std::size_t bytes() const;

  private:
    /// The vertices that the faces refer to.
    std::span<const Vec3f> vertices(int knot) const;
    void add_polygons();
    void add_limit_surface(const Progress& progress);

    SharedGeometry m_shared;
    int m_side = 1;  ///< cells along a side of a patch of a subdivision surface
    int m_knots = 1;
    std::vector<Vec3f> m_points;  ///< [knots][points]
    std::vector<std::array<std::uint32_t, 3>> m_triangles;
    std::vector<std::uint32_t> m_patches;  ///< [triangles] polygons: patch, doubled, plus half
    std::vector<float> m_errors;           ///< [faces]; empty = all 0
    float m_extent = 0.0f;
};

}  // namespace granita
