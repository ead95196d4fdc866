// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons as triangles for rays.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/shared_geometry.h"
#include "shade/rays/ray_faces.h"

namespace granita {

class RayMesh final : public RayFaces<3> {
  public:
    explicit RayMesh(std::shared_ptr<const SharedGeometry> shared);

    std::string size() const override;
    /// The triangles are the surface.
    float error(std::uint32_t) const override { return 0.0f; }
    /// (u, v): the barycentric point of a triangle.
    void locate(std::uint32_t geometry, std::uint32_t triangle, float u, float v,
                RayHit& hit) const override;
    std::size_t bytes() const override;

  private:
    void add_polygons();

    std::vector<std::uint32_t> m_patches;  ///< [triangles] patch, doubled, plus half
};

}  // namespace granita
