// SPDX-License-Identifier: GPL-3.0-or-later
// How far displacement moves a mesh's vertices: each as its owner says, whichever faces are around.
#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace granita {

class OpenedMesh;

class VertexOffsets {
  public:
    /// Of what is not displaced.
    VertexOffsets() = default;
    /// `wanted` [vertices of the part]: those whose offsets are found.
    VertexOffsets(const OpenedMesh& mesh, const std::vector<bool>& wanted);

    /// Object space; `place` in the part.
    const Vec3f& operator[](std::size_t place) const { return m_offsets[place]; }
    /// Where the vertex is at a knot, camera space.
    Vec3f point(const OpenedMesh& mesh, int knot, std::size_t place) const;
    /// [vertices of the part] the same of all that were wanted.
    std::vector<Vec3f> points(const OpenedMesh& mesh, int knot) const;
    std::uint64_t bytes() const { return sizeof(Vec3f) * m_offsets.size(); }

  private:
    std::vector<Vec3f> m_offsets;
};

}  // namespace granita
