// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons as triangles for rays.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/shared_geometry.h"
#include "shade/rays/ray_primitives.h"
#include "shade/rays/ray_shape.h"

namespace granita {

class RayMesh final : public RayShape {
  public:
    explicit RayMesh(std::shared_ptr<const SharedGeometry> shared);

    std::vector<RTCGeometry> hand_over(RTCDevice device) override;
    std::string size() const override;
    int knots() const override { return m_triangles.knots; }
    /// The triangles are the surface.
    float error(std::uint32_t) const override { return 0.0f; }
    float extent(std::uint32_t face) const override;
    /// (u, v): the barycentric point of a triangle.
    void locate(std::uint32_t geometry, std::uint32_t triangle, float u, float v,
                ShadowHit& hit) const override;
    std::size_t bytes() const override;

  private:
    void add_polygons();

    std::shared_ptr<const SharedGeometry> m_shared;
    RayPrimitives<3> m_triangles;
    std::vector<std::uint32_t> m_patches;  ///< [triangles] patch, doubled, plus half
    std::vector<float> m_extents;          ///< [F]
};

}  // namespace granita
