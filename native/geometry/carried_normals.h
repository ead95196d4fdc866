// SPDX-License-Identifier: GPL-3.0-or-later
// Corner normals that a mesh was given, where its shape is another: each goes along with the faces
// around its vertex that have it in common, so that what was smooth stays so and what was sharp
// too. What the frame shows plane by chance counts as smooth, but for faces that are said to be
// flat.
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

    /// Which of at() a corner has.
    std::uint32_t group(std::uint32_t corner) const { return m_group[corner]; }
    /// [groups] unit or zero, object space, where the vertices are at `points`.
    std::vector<Vec3f> at(std::span<const Vec3f> points) const;

  private:
    void find_groups();

    const SharedGeometry& m_geometry;
    std::vector<std::uint32_t> m_group;  ///< [corners] of one vertex and one normal
    std::uint32_t m_group_count = 0;
};

}  // namespace granita
