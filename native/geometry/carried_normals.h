// SPDX-License-Identifier: GPL-3.0-or-later
// Corner normals that a mesh was given, where its shape is another: each goes along with the faces
// around its vertex that have it in common, so that what was smooth stays so and what was sharp
// too.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace granita {

class SharedGeometry;

class CarriedNormals {
  public:
    /// The geometry outlives this.
    explicit CarriedNormals(const SharedGeometry& geometry);

    /// [corners] unit or zero, object space, where the vertices are at `points`.
    std::vector<Vec3f> at(std::span<const Vec3f> points) const;

  private:
    void find_groups();
    /// What the face adds to the normal of one of its corners, between `before` and `after`.
    Vec3d share(std::span<const Vec3f> points, std::uint32_t before, std::uint32_t corner,
                std::uint32_t after) const;

    const SharedGeometry& m_geometry;
    std::vector<std::uint32_t> m_group;  ///< [corners] of one vertex and one normal
    std::uint32_t m_group_count = 0;
};

}  // namespace granita
